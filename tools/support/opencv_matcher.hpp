// OpenCV's matchers, for comparison; stereo_image_proc offers the first two.
#pragma once

#include <array>
#include <opencv2/calib3d.hpp>

namespace fpga_stereo::tools {

enum class OpencvMatcher { kBm, kSgbm, kSgbm3Way, kSgbmHh };
constexpr std::array<OpencvMatcher, 4> kOpencvMatchers{
    OpencvMatcher::kBm, OpencvMatcher::kSgbm, OpencvMatcher::kSgbm3Way, OpencvMatcher::kSgbmHh};
/// Returns StereoBM, StereoSGBM, StereoSGBM_3WAY or StereoSGBM_HH.
const char* to_text(OpencvMatcher matcher);

constexpr int kStereoBmWindow = 15;

/// Creates StereoBM (window kStereoBmWindow) or StereoSGBM (block size 5, penalties as recommended
/// in OpenCV's manual; five paths, three with 3WAY, eight over the whole image with HH).
/// Uniqueness, left-right check and speckle filter are set as in stereo_image_proc. `disparities`
/// must be a multiple of 16.
cv::Ptr<cv::StereoMatcher> make_opencv_matcher(OpencvMatcher kind, int disparities);

/// Computes the disparity of a rectified pair (8UC1) with a matcher made by make_opencv_matcher().
/// The result is in 1/32 px from `min_disparity` on; kNoDisparity = invalid. The search range is
/// rounded up to the multiple of 16 that the matchers need.
cv::Mat1w opencv_disparity(OpencvMatcher kind, const cv::Mat1b& left, const cv::Mat1b& right,
                           int min_disparity, int disparity_range);

/// StereoBM computes nothing for half a window at the top and bottom. Copies the nearest row to
/// these rows, so that they do not all count as bad once holes are filled.
void extend_rows(cv::Mat1w& disparity);

}  // namespace fpga_stereo::tools
