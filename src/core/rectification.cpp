// Computes meshes from exact maps, their deviation and what they need of the line buffer.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {
namespace {

constexpr double kMaxDeviation = 1.0;  // px between mesh and exact map

/// Converts a displacement in px to units of a mesh node; saturates.
std::int16_t node_units(double displacement) {
  constexpr double kLimit = std::numeric_limits<std::int16_t>::max();
  // Half up, as everywhere else in the pipeline.
  const double units = std::floor(displacement * kMeshScale + 0.5);
  return static_cast<std::int16_t>(std::clamp(units, -kLimit, kLimit));
}

}  // namespace

Result<CameraRectification> make_rectification(const ExactMap& map, cv::Size rectified,
                                               cv::Size raw, const std::string& camera) {
  CameraRectification camera_rectification;
  camera_rectification.mesh.size = rectified;
  camera_rectification.mesh.nodes.create(Mesh::node_count(rectified));
  for (int j = 0; j < camera_rectification.mesh.nodes.rows; ++j) {
    for (int i = 0; i < camera_rectification.mesh.nodes.cols; ++i) {
      const cv::Point2d at(i * kMeshPitch, j * kMeshPitch);
      const cv::Point2d source = map(at.x, at.y);
      if (!std::isfinite(source.x) || !std::isfinite(source.y)) {
        return Error{
            ErrorKind::kCalibration,
            fmt::format("{} camera: rectified pixel ({}, {}) has no source: its ray points "
                        "behind the camera",
                        camera, at.x, at.y)};
      }
      // Nodes far outside the raw image saturate; mesh_deviation() shows it if a pixel is affected.
      camera_rectification.mesh.nodes(j, i) = {node_units(source.x - at.x),
                                               node_units(source.y - at.y)};
    }
  }
  camera_rectification.deviation = mesh_deviation(camera_rectification.mesh, map, raw);
  if (camera_rectification.deviation.max > kMaxDeviation) {
    return Error{
        ErrorKind::kCalibration,
        fmt::format("{} camera: the rectification mesh is {:.6g} px off the exact map at "
                    "pixel ({}, {}): allowed up to {}; pixels may move by less than 256 px",
                    camera, camera_rectification.deviation.max,
                    camera_rectification.deviation.max_at.x,
                    camera_rectification.deviation.max_at.y, kMaxDeviation)};
  }
  camera_rectification.line_buffer = line_buffer_need(camera_rectification.mesh, raw);
  return camera_rectification;
}

MeshDeviation mesh_deviation(const Mesh& mesh, const ExactMap& map, cv::Size raw) {
  MeshDeviation result;
  double sum = 0;
  for (int y = 0; y < mesh.size.height; ++y) {
    const MeshRow row(mesh, y);
    for (int x = 0; x < mesh.size.width; ++x) {
      const cv::Point2d exact = map(x, y);
      const bool inside =
          exact.x >= 0 && exact.y >= 0 && exact.x <= raw.width - 1 && exact.y <= raw.height - 1;
      if (!inside) continue;
      const double distance = cv::norm(cv::Point2d(row.source(x)) / kSourceScale - exact);
      if (distance > result.max) {
        result.max = distance;
        result.max_at = {x, y};
      }
      sum += distance * distance;
      ++result.pixels;
    }
  }
  if (result.pixels > 0) result.rms = std::sqrt(sum / static_cast<double>(result.pixels));
  return result;
}

LineBufferNeed line_buffer_need(const Mesh& mesh, cv::Size raw) {
  // Raster positions of raw pixels, relative to the rectified pixel that reads them.
  std::int64_t oldest = std::numeric_limits<std::int64_t>::max();
  std::int64_t newest = std::numeric_limits<std::int64_t>::min();
  LineBufferNeed need;
  for (int y = 0; y < mesh.size.height; ++y) {
    const MeshRow row(mesh, y);
    for (int x = 0; x < mesh.size.width; ++x) {
      const cv::Point source = row.source(x);
      const cv::Point tap(source.x >> kSourceShift, source.y >> kSourceShift);
      // The taps that lie in the raw image; the others are 0 without being read.
      const int left = std::max(tap.x, 0), right = std::min(tap.x + 1, raw.width - 1);
      const int top = std::max(tap.y, 0), bottom = std::min(tap.y + 1, raw.height - 1);
      if (left > right || top > bottom) continue;
      need.rows_above = std::max(need.rows_above, y - top);
      need.rows_below = std::max(need.rows_below, bottom - y);
      const std::int64_t now = std::int64_t{y} * raw.width + x;
      oldest = std::min(oldest, std::int64_t{top} * raw.width + left - now);
      newest = std::max(newest, std::int64_t{bottom} * raw.width + right - now);
    }
  }
  if (newest < oldest) return need;  // no raw pixel is read
  need.read_start = std::max<std::int64_t>(0, newest + 1);
  need.rows = static_cast<int>((need.read_start - oldest + raw.width - 1) / raw.width);
  return need;
}

Status check_line_buffer(const LineBufferNeed& need, int rows, const std::string& camera) {
  if (need.rows <= rows) return {};
  return Error{ErrorKind::kCalibration,
               fmt::format("{} camera: its rectification needs a line buffer of {} rows ({} above "
                           "and {} below the output row): the buffer has {}",
                           camera, need.rows, need.rows_above, need.rows_below, rows)};
}

}  // namespace fpga_stereo
