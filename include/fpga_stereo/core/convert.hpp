// Converts disparity images of the pipeline to floats, depth and colours. Pixels of kNoDisparity
// are invalid; all other values are valid.
#pragma once

#include <opencv2/core.hpp>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {

/// Converts disparities to metres as the Q matrix of image_geometry::StereoCameraModel does:
///   d = value / 32 + offset, Z = fx T / d, X = T (u - cx) / d, Y = T fx / fy (v - cy) / d.
struct Reprojection {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // px
  double baseline = 0;                    // T, m
  double offset = 0;                      // px: min_disparity - (cx_left - cx_right)
};

/// Returns the reprojection of disparities that were searched from `min_disparity` on.
Reprojection make_reprojection(const StereoGeometry& geometry, int min_disparity);

/// Converts to px plus `offset`. Invalid pixels become `invalid`.
void to_float(const cv::Mat1w& disparity, double offset, float invalid, cv::Mat1f& out);

/// Converts to depth in metres. Pixels that are invalid, or whose depth is not positive and finite,
/// become a quiet NaN.
void to_depth(const cv::Mat1w& disparity, const Reprojection& r, cv::Mat1f& out);

/// Converts to depth in millimetres, rounded. Pixels that are invalid, or whose depth is not
/// positive or does not fit into 16 bits, become 0.
void to_depth(const cv::Mat1w& disparity, const Reprojection& r, cv::Mat1w& out);

/// Converts to colours for people (OpenCV's Turbo map over the search range): near is red, far is
/// blue, invalid is black.
void to_color(const cv::Mat1w& disparity, int disparity_range, cv::Mat3b& out);

}  // namespace fpga_stereo
