#include "fpga_stereo/core/cloud.hpp"

#include <array>
#include <cmath>
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

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kSmallest = 1e-9;  // px; coordinates of smaller disparities overflow a float

/// The disparities of the pipeline in px, rounded as to_float() does, so that a cloud made of the
/// floats has the same bytes.
struct PipelineDisparities {
  const cv::Mat1w& image;
  double offset;

  /// Returns a function that returns the disparity of a column, or NaN if it has none.
  auto row(int y) const {
    return [in = image[y], this](int x) -> double {
      if (in[x] == kNoDisparity) return kNaN;
      return static_cast<float>(static_cast<double>(in[x]) / kDisparityScale + offset);
    };
  }
};

/// Disparities in px.
struct FloatDisparities {
  const cv::Mat1f& image;
  float min;

  auto row(int y) const {
    return [in = image[y], this](int x) -> double {
      return std::isfinite(in[x]) && in[x] >= min ? in[x] : kNaN;
    };
  }
};

/// Writes a row of points to `out`. Returns the end of what was written.
template <PointColor kColor, int kChannels, bool kPadded, class DisparityOf>
std::uint8_t* write_row(DisparityOf disparity_of, const std::uint8_t* color, int width, int y,
                        const Reprojection& r, const CloudLayout& layout, std::uint8_t* out) {
  constexpr CloudLayout kLayout{kColor, kPadded, true, 1};
  constexpr std::size_t kStep = kLayout.point_step();
  constexpr std::size_t kColorAt = kLayout.color_offset() / sizeof(float);
  const double row = (y - r.cy) * r.fx / r.fy;
  for (int x = 0; x < width; x += layout.decimation) {
    const double d = disparity_of(x);
    const bool valid = d > kSmallest;  // false for NaN
    if (!valid && !layout.organized) continue;
    const double metres_per_px = valid ? r.baseline / d : kNaN;
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

template <PointColor kColor, bool kPadded, class DisparityOf>
auto writer(int channels) {
  return channels == 3 ? write_row<kColor, 3, kPadded, DisparityOf>
                       : write_row<kColor, 1, kPadded, DisparityOf>;
}

template <PointColor kColor, class DisparityOf>
auto writer(bool padded, int channels) {
  return padded ? writer<kColor, true, DisparityOf>(channels)
                : writer<kColor, false, DisparityOf>(channels);
}

template <class DisparityOf>
auto writer(const CloudLayout& layout, int channels) {
  switch (layout.color) {
    case PointColor::kRgb:
      return writer<PointColor::kRgb, DisparityOf>(layout.padded, channels);
    case PointColor::kMono:
      return writer<PointColor::kMono, DisparityOf>(layout.padded, channels);
    case PointColor::kNone:
      break;
  }
  return writer<PointColor::kNone, DisparityOf>(layout.padded, channels);
}

template <class Disparities>
void write_cloud(const Disparities& disparities, const Reprojection& r, const cv::Mat& color,
                 const CloudLayout& layout, Cloud& out) {
  const cv::Size size = disparities.image.size();
  const int step = layout.point_step();
  const int n = layout.decimation;
  out.width = (size.width + n - 1) / n;
  out.height = (size.height + n - 1) / n;
  // All bytes are written below, so old contents do not matter.
  out.data.resize(static_cast<std::size_t>(out.width) * out.height * step);

  const auto write = writer<decltype(disparities.row(0))>(layout, color.channels());
  std::uint8_t* point = out.data.data();
  for (int y = 0; y < size.height; y += n) {
    const std::uint8_t* pixels = layout.color == PointColor::kNone ? nullptr : color.ptr(y);
    point = write(disparities.row(y), pixels, size.width, y, r, layout, point);
  }
  if (!layout.organized) {
    out.data.resize(static_cast<std::size_t>(point - out.data.data()));
    out.width = static_cast<int>(out.data.size()) / step;
    out.height = 1;
  }
}

}  // namespace

void to_cloud(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
              const CloudLayout& layout, Cloud& out) {
  write_cloud(PipelineDisparities{disparity, r.offset}, r, color, layout, out);
}

void to_cloud(const cv::Mat1f& disparity, float min_disparity, const Reprojection& r,
              const cv::Mat& color, const CloudLayout& layout, Cloud& out) {
  write_cloud(FloatDisparities{disparity, min_disparity}, r, color, layout, out);
}

}  // namespace fpga_stereo
