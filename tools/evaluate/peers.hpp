// The block matchers that stereo_image_proc offers, to compare with.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>

namespace fpga_stereo::tools {

constexpr std::array<const char*, 2> kPeers{"StereoBM", "SGBM"};

/// What OpenCV's StereoBM (window 15) or StereoSGBM (block 5) makes of a rectified pair (8UC1),
/// with uniqueness, left-right check and speckle filter on: 1/32 px, kNoDisparity = none. The range
/// is rounded up to the multiple of 16 that they need.
cv::Mat1w peer_disparity(const std::string& peer, const cv::Mat& left, const cv::Mat& right,
                         int disparity_range);

}  // namespace fpga_stereo::tools
