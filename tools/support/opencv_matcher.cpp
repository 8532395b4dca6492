#include "support/opencv_matcher.hpp"

namespace fpga_stereo::tools {

cv::Ptr<cv::StereoMatcher> make_opencv_matcher(OpencvMatcher kind, int disparities) {
  constexpr int kUniqueness = 15, kMaxDifference = 1, kSpeckleSize = 100, kSpeckleRange = 4;
  cv::Ptr<cv::StereoMatcher> matcher;
  if (kind == OpencvMatcher::kBm) {
    const auto bm = cv::StereoBM::create(disparities, kStereoBmWindow);
    bm->setUniquenessRatio(kUniqueness);
    matcher = bm;
  } else {
    constexpr int kBlock = 5;
    const int mode =
        kind == OpencvMatcher::kSgbm ? cv::StereoSGBM::MODE_SGBM : cv::StereoSGBM::MODE_SGBM_3WAY;
    matcher =
        cv::StereoSGBM::create(0, disparities, kBlock, 8 * kBlock * kBlock, 32 * kBlock * kBlock,
                               kMaxDifference, 31, kUniqueness, kSpeckleSize, kSpeckleRange, mode);
  }
  matcher->setDisp12MaxDiff(kMaxDifference);
  matcher->setSpeckleWindowSize(kSpeckleSize);
  matcher->setSpeckleRange(kSpeckleRange);
  return matcher;
}

}  // namespace fpga_stereo::tools
