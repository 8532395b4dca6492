// Converts disparity and colour images to point clouds in the byte layouts of PCL and rviz.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/convert.hpp"

namespace fpga_stereo {

enum class PointColor {
  kRgb,   // a float field with the bytes b, g, r, 0
  kMono,  // a float field with the intensity, 0 .. 255
  kNone,  // no colour field
};

struct CloudLayout {
  PointColor color = PointColor::kRgb;
  bool padded = true;     // aligned as PCL does it: 32 bytes, 16 for kNone; else 16 and 12
  bool organized = true;  // a point per pixel, NaN if invalid; else valid points only
  int decimation = 1;     // >= 1; uses every n-th column of every n-th row

  constexpr int color_offset() const { return padded ? 16 : 12; }
  constexpr int point_step() const {
    if (padded) return color == PointColor::kNone ? 16 : 32;
    return color == PointColor::kNone ? 12 : 16;
  }
};

struct Cloud {
  int width = 0, height = 0;  // points; the height is 1 if not organized
  std::vector<std::uint8_t> data;
};

/// Converts to points in metres: x right, y down, z forward from the left camera. `color` is the
/// left rectified image, 8UC1 or 8UC3 (bgr), of the size of `disparity`; it may be empty for kNone.
/// Invalid points have a colour, too. A point is valid if its pixel has a disparity and its depth
/// is positive. Reuses the memory of `out`.
void to_cloud(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
              const CloudLayout& layout, Cloud& out);

/// The same for disparities in px, as to_float() and other programs write them; the offset of `r`
/// is not used. A pixel has no disparity if its value is below `min_disparity` or not finite.
void to_cloud(const cv::Mat1f& disparity, float min_disparity, const Reprojection& r,
              const cv::Mat& color, const CloudLayout& layout, Cloud& out);

}  // namespace fpga_stereo
