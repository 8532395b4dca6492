// The block matchers of stereo_image_proc, for comparison.
#pragma once

#include <opencv2/calib3d.hpp>

namespace fpga_stereo::tools {

enum class OpencvMatcher { kBm, kSgbm, kSgbm3Way };

constexpr int kStereoBmWindow = 15;

/// Creates StereoBM (window kStereoBmWindow) or StereoSGBM (block size 5, penalties as recommended
/// in OpenCV's manual). Uniqueness, left-right check and speckle filter are set as in
/// stereo_image_proc. `disparities` must be a multiple of 16.
cv::Ptr<cv::StereoMatcher> make_opencv_matcher(OpencvMatcher kind, int disparities);

}  // namespace fpga_stereo::tools
