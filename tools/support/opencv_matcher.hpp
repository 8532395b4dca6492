// The block matchers that stereo_image_proc offers, to compare with.
#pragma once

#include <opencv2/calib3d.hpp>

namespace fpga_stereo::tools {

enum class OpencvMatcher { kBm, kSgbm, kSgbm3Way };

constexpr int kStereoBmWindow = 15;

/// StereoBM (kStereoBmWindow) or StereoSGBM (block 5, with the penalties that OpenCV's manual
/// recommends), with uniqueness, left-right check and speckle filter as stereo_image_proc sets
/// them. `disparities` is a multiple of 16.
cv::Ptr<cv::StereoMatcher> make_opencv_matcher(OpencvMatcher kind, int disparities);

}  // namespace fpga_stereo::tools
