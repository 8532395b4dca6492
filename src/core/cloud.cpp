#include "fpga_stereo/core/cloud.hpp"

#include <cstring>
#include <limits>

#include "fpga_stereo/core/stages.hpp"

namespace fpga_stereo {
namespace {

void write_color(const cv::Mat& color, int x, int y, PointColor kind, std::uint8_t* out) {
  if (kind == PointColor::kNone) return;
  const int channels = color.channels();
  const std::uint8_t* pixel = color.ptr(y) + static_cast<std::ptrdiff_t>(x) * channels;
  if (kind == PointColor::kRgb) {
    out[0] = pixel[0];
    out[1] = pixel[channels / 2];
    out[2] = pixel[channels - 1];
    return;
  }
  // ITU-R BT.601, as OpenCV converts BGR to grey.
  const float grey = channels == 1 ? static_cast<float>(pixel[0])
                                   : 0.114F * pixel[0] + 0.587F * pixel[1] + 0.299F * pixel[2];
  std::memcpy(out, &grey, sizeof grey);
}

}  // namespace

int CloudLayout::point_step() const {
  if (padded) return color == PointColor::kNone ? 16 : 32;
  return color == PointColor::kNone ? 12 : 16;
}

void to_cloud(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
              const CloudLayout& layout, Cloud& out) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  const int step = layout.point_step();
  const int n = layout.decimation;
  out.width = (disparity.cols + n - 1) / n;
  out.height = (disparity.rows + n - 1) / n;
  out.data.assign(static_cast<std::size_t>(out.width) * out.height * step, 0);

  std::uint8_t* point = out.data.data();
  for (int y = 0; y < disparity.rows; y += n) {
    const std::uint16_t* row = disparity[y];
    for (int x = 0; x < disparity.cols; x += n) {
      const double d = static_cast<double>(row[x]) / kDisparityScale + r.offset;
      const bool valid = row[x] != kNoDisparity && d > 0;
      if (!valid && !layout.organized) continue;
      float xyz[3] = {kNone, kNone, kNone};
      if (valid) {
        const double per_pixel = r.baseline / d;
        xyz[0] = static_cast<float>((x - r.cx) * per_pixel);
        xyz[1] = static_cast<float>((y - r.cy) * per_pixel * r.fx / r.fy);
        xyz[2] = static_cast<float>(r.fx * per_pixel);
      }
      std::memcpy(point, xyz, sizeof xyz);
      write_color(color, x, y, layout.color, point + layout.color_offset());
      point += step;
    }
  }
  if (!layout.organized) {
    out.data.resize(static_cast<std::size_t>(point - out.data.data()));
    out.width = static_cast<int>(out.data.size()) / step;
    out.height = 1;
  }
}

}  // namespace fpga_stereo
