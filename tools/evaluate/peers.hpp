// Disparities of the block matchers of stereo_image_proc, for comparison.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <string>

namespace fpga_stereo::tools {

constexpr std::array<const char*, 2> kPeers{"StereoBM", "SGBM"};

/// Computes the disparity of a rectified pair (8UC1) with a matcher of kPeers, made by
/// make_opencv_matcher(). The result is in 1/32 px; kNoDisparity = invalid. The search range is
/// rounded up to the multiple of 16 that the matchers need.
cv::Mat1w peer_disparity(const std::string& peer, const cv::Mat& left, const cv::Mat& right,
                         int disparity_range);

}  // namespace fpga_stereo::tools
