// Disparity and colour to points, in one pass, in the byte layouts that PCL and rviz read.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/convert.hpp"

namespace fpga_stereo {

enum class PointColor {
  kRgb,   // bytes b, g, r, 0 in a float field
  kMono,  // intensity, float, 0 .. 255
  kNone,  // xyz only
};

struct CloudLayout {
  PointColor color = PointColor::kRgb;
  bool padded = true;     // as PCL aligns: rgb and mono 32 bytes, xyz 16; else 16, 16, 12
  bool organized = true;  // as the image, NaN where there is no point; else valid points only
  int decimation = 1;     // every n-th column of every n-th row

  constexpr int color_offset() const { return padded ? 16 : 12; }
  constexpr int point_step() const {
    if (padded) return color == PointColor::kNone ? 16 : 32;
    return color == PointColor::kNone ? 12 : 16;
  }
};

struct Cloud {
  int width = 0, height = 0;  // points; height 1 where not organized
  std::vector<std::uint8_t> data;
};

/// Points in metres: x right, y down, z forward from the left camera. `color` is the left
/// rectified image, 8UC1 or 8UC3 (bgr), of the size of the disparity (may be empty for kNone); it
/// also fills points without a place. A point is valid where there is a disparity and its depth is
/// positive. layout.decimation must be 1 or more. `out` may be used again: its memory is kept.
void to_cloud(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
              const CloudLayout& layout, Cloud& out);

}  // namespace fpga_stereo
