#include "fpga_stereo/core/mesh.hpp"

namespace fpga_stereo {

cv::Size Mesh::node_count(cv::Size size) {
  return {(size.width + kMeshPitch - 1) / kMeshPitch + 1,
          (size.height + kMeshPitch - 1) / kMeshPitch + 1};
}

Mesh Mesh::shift(cv::Size size, int shift_x) {
  const cv::Vec2s displacement(static_cast<std::int16_t>(shift_x * kMeshScale), 0);
  return {size, cv::Mat_<cv::Vec2s>(node_count(size), displacement)};
}

MeshRow::MeshRow(const Mesh& mesh, int y) : y_(y), columns_(mesh.nodes.cols) {
  const cv::Vec2s* upper = mesh.nodes[y / kMeshPitch];
  const cv::Vec2s* lower = mesh.nodes[y / kMeshPitch + 1];
  const int weight = y % kMeshPitch;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    columns_[i].x = upper[i][0] * kMeshPitch + (lower[i][0] - upper[i][0]) * weight;
    columns_[i].y = upper[i][1] * kMeshPitch + (lower[i][1] - upper[i][1]) * weight;
  }
}

cv::Point MeshRow::source(int x) const {
  constexpr int kUnits = kMeshScale * kMeshPitch * kMeshPitch / kSourceScale;  // per 1/32 px
  const cv::Point left = columns_[x / kMeshPitch];
  const cv::Point step = columns_[x / kMeshPitch + 1] - left;
  const cv::Point exact = left * kMeshPitch + step * (x % kMeshPitch);
  // An arithmetic shift rounds towards minus infinity, so adding half a unit first rounds half up.
  static_assert(kUnits == 1 << 8);
  return {x * kSourceScale + ((exact.x + kUnits / 2) >> 8),
          y_ * kSourceScale + ((exact.y + kUnits / 2) >> 8)};
}

}  // namespace fpga_stereo
