// Meshes from exact maps, and what they cost: deviation and line buffer.
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {
namespace {

constexpr double kLargestDeviation = 1.0;  // px: a mesh further off than this is refused

std::int16_t node_units(double displacement) {
  constexpr double kLimit = std::numeric_limits<std::int16_t>::max();
  // Half up, as everywhere else in the pipeline.
  const double units = std::floor(displacement * kMeshScale + 0.5);
  return static_cast<std::int16_t>(std::clamp(units, -kLimit, kLimit));
}

}  // namespace

Result<CameraRectification> make_rectification(const ExactMap& map, cv::Size rectified,
                                               cv::Size raw, const std::string& camera) {
  CameraRectification made;
  made.mesh.size = rectified;
  made.mesh.nodes.create(Mesh::node_count(rectified));
  for (int j = 0; j < made.mesh.nodes.rows; ++j) {
    for (int i = 0; i < made.mesh.nodes.cols; ++i) {
      const cv::Point2d at(i * kMeshPitch, j * kMeshPitch);
      const cv::Point2d source = map(at.x, at.y);
      if (!std::isfinite(source.x) || !std::isfinite(source.y)) {
        std::ostringstream text;
        text << camera << " camera: rectified pixel (" << at.x << ", " << at.y
             << ") has no source: the calibration looks behind the camera";
        return Error{ErrorKind::kCalibration, text.str()};
      }
      // Far outside the raw image a node saturates; that is seen as a deviation if it matters.
      made.mesh.nodes(j, i) = {node_units(source.x - at.x), node_units(source.y - at.y)};
    }
  }
  made.deviation = mesh_deviation(made.mesh, map, raw);
  if (made.deviation.max > kLargestDeviation) {
    std::ostringstream text;
    text << camera << " camera: the rectification mesh is " << made.deviation.max
         << " px off the exact map at pixel (" << made.deviation.max_at.x << ", "
         << made.deviation.max_at.y << "): allowed " << kLargestDeviation
         << "; a pixel may move by less than 256 px";
    return Error{ErrorKind::kCalibration, text.str()};
  }
  made.line_buffer = line_buffer_need(made.mesh, raw);
  return made;
}

MeshDeviation mesh_deviation(const Mesh& mesh, const ExactMap& map, cv::Size raw) {
  MeshDeviation result;
  double sum = 0;
  std::int64_t count = 0;
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
      ++count;
    }
  }
  if (count > 0) result.rms = std::sqrt(sum / static_cast<double>(count));
  return result;
}

LineBufferNeed line_buffer_need(const Mesh& mesh, cv::Size raw) {
  // Raster numbers of raw pixels relative to the rectified pixel that reads them.
  std::int64_t oldest = std::numeric_limits<std::int64_t>::max();
  std::int64_t newest = std::numeric_limits<std::int64_t>::min();
  LineBufferNeed need;
  for (int y = 0; y < mesh.size.height; ++y) {
    const MeshRow row(mesh, y);
    for (int x = 0; x < mesh.size.width; ++x) {
      const cv::Point source = row.source(x);
      const cv::Point tap(source.x >> kSourceShift, source.y >> kSourceShift);
      // Of the 2 x 2 pixels, those in the raw image; the others read as 0.
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
  if (newest < oldest) return need;  // nothing of the raw image is seen
  need.read_start = std::max<std::int64_t>(0, newest + 1);
  need.rows = static_cast<int>((need.read_start - oldest + raw.width - 1) / raw.width);
  return need;
}

Status check_line_buffer(const LineBufferNeed& need, int rows, const std::string& camera) {
  if (need.rows <= rows) return {};
  std::ostringstream text;
  text << camera << " camera: its rectification needs a line buffer of " << need.rows << " rows ("
       << need.rows_above << " above and " << need.rows_below
       << " below the output row): the buffer has " << rows;
  return Error{ErrorKind::kCalibration, text.str()};
}

}  // namespace fpga_stereo
