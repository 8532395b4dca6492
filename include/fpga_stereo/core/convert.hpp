// From the pipeline's disparity to what people and other programs read. Everything here follows
// the marker kNoDisparity, never a magic value of the image.
#pragma once

#include <opencv2/core.hpp>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {

/// How a disparity image turns into metres (image_geometry::StereoCameraModel, Q matrix):
///   d = value / 32 + offset, Z = fx T / d, X = T (u - cx) / d, Y = T fx / fy (v - cy) / d.
struct Reprojection {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // px
  double baseline = 0;                    // T, m
  double offset = 0;                      // px: min_disparity - (cx_left - cx_right)
};

Reprojection make_reprojection(const StereoGeometry& geometry, int min_disparity);

/// 32-bit float px, offset added; `invalid` where there is none.
void to_float(const cv::Mat1w& disparity, double offset, float invalid, cv::Mat1f& out);

/// Metres; quiet NaN where there is no disparity or the depth is not positive and finite.
void to_depth(const cv::Mat1w& disparity, const Reprojection& r, cv::Mat1f& out);

/// Millimetres, rounded; 0 where there is none or it does not fit into 16 bits.
void to_depth(const cv::Mat1w& disparity, const Reprojection& r, cv::Mat1w& out);

/// A picture: near is red, far is blue (OpenCV's Turbo map over the search range), none is black.
void to_color(const cv::Mat1w& disparity, int disparity_range, cv::Mat3b& out);

}  // namespace fpga_stereo
