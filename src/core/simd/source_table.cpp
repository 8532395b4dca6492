#include "core/simd/source_table.hpp"

#include <algorithm>
#include <cstring>

#include "core/rectify_pixels.hpp"
#include "core/simd/kernels.hpp"

namespace fpga_stereo::simd {
namespace {

constexpr int kColumns = 16, kRows = 3;  // that are read for a cell

bool same(const Mesh& a, const Mesh& b) {
  if (a.size != b.size || a.nodes.size() != b.nodes.size()) return false;
  for (int y = 0; y < a.nodes.rows; ++y) {
    const std::size_t bytes = static_cast<std::size_t>(a.nodes.cols) * a.nodes.elemSize();
    if (std::memcmp(a.nodes[y], b.nodes[y], bytes) != 0) return false;
  }
  return true;
}

}  // namespace

void SourceTable::make(const Mesh& mesh, cv::Size raw, std::size_t pitch) {
  if (raw == raw_ && pitch == pitch_ && same(mesh, mesh_)) return;
  mesh_ = {mesh.size, mesh.nodes.clone()};
  raw_ = raw;
  pitch_ = pitch;
  cells_ = mesh.size.width / kMeshPitch;
  table_.clear();
  table_.reserve(static_cast<std::size_t>(cells_) * mesh.size.height);
  for (int y = 0; y < mesh.size.height; ++y) {
    const MeshRow row(mesh_, y);
    for (int cell = 0; cell < cells_; ++cell) table_.push_back(make_cell(row, cell * kMeshPitch));
  }
}

SourceCell SourceTable::make_cell(const MeshRow& row, int x) const {
  SourceCell cell{};
  cv::Point source[kMeshPitch], first(raw_.width, raw_.height);
  for (int i = 0; i < kMeshPitch; ++i) {
    source[i] = row.source(x + i);
    first.x = std::min(first.x, source[i].x >> kSourceShift);
    first.y = std::min(first.y, source[i].y >> kSourceShift);
  }
  cell.offset = -1;
  if (first.x < 0 || first.y < 0 || first.x + kColumns > raw_.width ||
      first.y + kRows > raw_.height) {
    return cell;
  }
  for (int i = 0; i < kMeshPitch; ++i) {
    const cv::Point from =
        cv::Point(source[i].x >> kSourceShift, source[i].y >> kSourceShift) - first;
    if (from.x + 2 > kColumns || from.y + 2 > kRows) return cell;
    cell.column[i] = static_cast<std::uint8_t>(from.x);
    cell.wx[i] = static_cast<std::uint8_t>(source[i].x & (kSourceScale - 1));
    cell.wy[i] = static_cast<std::uint8_t>((source[i].y & (kSourceScale - 1)) |
                                           (from.y > 0 ? kSecondRow : 0));
  }
  cell.offset = first.y * static_cast<int>(pitch_) + first.x;
  return cell;
}

void SourceTable::rectify(const cv::Mat1b& raw, int y, std::uint8_t* out) const {
  const SourceCell* cells = table_.data() + static_cast<std::ptrdiff_t>(y) * cells_;
  const int left_out = rectify_cells(raw, cells, cells_, out);
  const int done = cells_ * kMeshPitch;
  if (left_out == 0 && done == mesh_.size.width) return;
  const MeshRow row(mesh_, y);
  for (int cell = 0; left_out > 0 && cell < cells_; ++cell) {
    if (cells[cell].offset >= 0) continue;
    rectify_pixels<1>(raw, row, cell * kMeshPitch, (cell + 1) * kMeshPitch, out);
  }
  rectify_pixels<1>(raw, row, done, mesh_.size.width, out);
}

}  // namespace fpga_stereo::simd
