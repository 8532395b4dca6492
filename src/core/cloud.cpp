#include "fpga_stereo/core/cloud.hpp"

#include <array>
#include <cstring>
#include <limits>

#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

/// A point of the largest layout: x, y, z, 0, colour, 0, 0, 0.
using Point = std::array<float, 8>;

/// Returns the colour field of a point.
template <PointColor kColor, int kChannels>
float color_field(const std::uint8_t* pixel) {
  if constexpr (kColor == PointColor::kMono && kChannels == 1) return pixel[0];
  if constexpr (kColor == PointColor::kMono) {
    // ITU-R BT.601, as OpenCV converts BGR to grey.
    return 0.114F * pixel[0] + 0.587F * pixel[1] + 0.299F * pixel[2];
  }
  const std::array<std::uint8_t, 4> bytes{pixel[0], pixel[kChannels / 2], pixel[kChannels - 1], 0};
  float field = 0;
  std::memcpy(&field, bytes.data(), sizeof field);
  return field;
}

/// Writes a row of points to `out`. Returns the end of what was written.
template <PointColor kColor, int kChannels, bool kPadded>
std::uint8_t* write_row(const std::uint16_t* disparity, const std::uint8_t* color, int width, int y,
                        const Reprojection& r, const CloudLayout& layout, std::uint8_t* out) {
  constexpr CloudLayout kLayout{kColor, kPadded, true, 1};
  constexpr std::size_t kStep = kLayout.point_step();
  constexpr std::size_t kColorAt = kLayout.color_offset() / sizeof(float);
  const double row = (y - r.cy) * r.fx / r.fy;
  for (int x = 0; x < width; x += layout.decimation) {
    const double d = static_cast<double>(disparity[x]) / kDisparityScale + r.offset;
    const bool valid = disparity[x] != kNoDisparity && d > 0;
    if (!valid && !layout.organized) continue;
    const double metres_per_px = valid ? r.baseline / d : std::numeric_limits<double>::quiet_NaN();
    Point point{};
    point[0] = static_cast<float>((x - r.cx) * metres_per_px);
    point[1] = static_cast<float>(row * metres_per_px);
    point[2] = static_cast<float>(r.fx * metres_per_px);
    if constexpr (kColor != PointColor::kNone) {
      point[kColorAt] =
          color_field<kColor, kChannels>(color + static_cast<std::ptrdiff_t>(x) * kChannels);
    }
    std::memcpy(out, point.data(), kStep);
    out += kStep;
  }
  return out;
}

template <PointColor kColor, bool kPadded>
auto writer(int channels) {
  return channels == 3 ? write_row<kColor, 3, kPadded> : write_row<kColor, 1, kPadded>;
}

template <PointColor kColor>
auto writer(bool padded, int channels) {
  return padded ? writer<kColor, true>(channels) : writer<kColor, false>(channels);
}

auto writer(const CloudLayout& layout, int channels) {
  switch (layout.color) {
    case PointColor::kRgb:
      return writer<PointColor::kRgb>(layout.padded, channels);
    case PointColor::kMono:
      return writer<PointColor::kMono>(layout.padded, channels);
    case PointColor::kNone:
      break;
  }
  return writer<PointColor::kNone>(layout.padded, channels);
}

}  // namespace

void to_cloud(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
              const CloudLayout& layout, Cloud& out) {
  const int step = layout.point_step();
  const int n = layout.decimation;
  out.width = (disparity.cols + n - 1) / n;
  out.height = (disparity.rows + n - 1) / n;
  // All bytes are written below, so old contents do not matter.
  out.data.resize(static_cast<std::size_t>(out.width) * out.height * step);

  const auto write = writer(layout, color.channels());
  std::uint8_t* point = out.data.data();
  for (int y = 0; y < disparity.rows; y += n) {
    const std::uint8_t* pixels = layout.color == PointColor::kNone ? nullptr : color.ptr(y);
    point = write(disparity[y], pixels, disparity.cols, y, r, layout, point);
  }
  if (!layout.organized) {
    out.data.resize(static_cast<std::size_t>(point - out.data.data()));
    out.width = static_cast<int>(out.data.size()) / step;
    out.height = 1;
  }
}

}  // namespace fpga_stereo
