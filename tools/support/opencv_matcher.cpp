#include "support/opencv_matcher.hpp"

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::tools {

namespace {

int sgbm_mode(OpencvMatcher kind) {
  if (kind == OpencvMatcher::kSgbm3Way) return cv::StereoSGBM::MODE_SGBM_3WAY;
  return kind == OpencvMatcher::kSgbmHh ? cv::StereoSGBM::MODE_HH : cv::StereoSGBM::MODE_SGBM;
}

}  // namespace

const char* to_text(OpencvMatcher matcher) {
  switch (matcher) {
    case OpencvMatcher::kBm:
      return "StereoBM";
    case OpencvMatcher::kSgbm:
      return "StereoSGBM";
    case OpencvMatcher::kSgbm3Way:
      return "StereoSGBM_3WAY";
    case OpencvMatcher::kSgbmHh:
      break;
  }
  return "StereoSGBM_HH";
}

cv::Ptr<cv::StereoMatcher> make_opencv_matcher(OpencvMatcher kind, int disparities) {
  constexpr int kUniqueness = 15, kMaxDifference = 1, kSpeckleSize = 100, kSpeckleRange = 4;
  cv::Ptr<cv::StereoMatcher> matcher;
  if (kind == OpencvMatcher::kBm) {
    const auto bm = cv::StereoBM::create(disparities, kStereoBmWindow);
    bm->setUniquenessRatio(kUniqueness);
    matcher = bm;
  } else {
    constexpr int kBlock = 5;
    matcher = cv::StereoSGBM::create(0, disparities, kBlock, 8 * kBlock * kBlock,
                                     32 * kBlock * kBlock, kMaxDifference, 31, kUniqueness,
                                     kSpeckleSize, kSpeckleRange, sgbm_mode(kind));
  }
  matcher->setDisp12MaxDiff(kMaxDifference);
  matcher->setSpeckleWindowSize(kSpeckleSize);
  matcher->setSpeckleRange(kSpeckleRange);
  return matcher;
}

cv::Mat1w opencv_disparity(OpencvMatcher kind, const cv::Mat1b& left, const cv::Mat1b& right,
                           int min_disparity, int disparity_range) {
  const auto matcher = make_opencv_matcher(kind, (disparity_range + 15) / 16 * 16);
  matcher->setMinDisparity(min_disparity);
  cv::Mat1s found;
  matcher->compute(left, right, found);
  constexpr int kScale = cv::StereoMatcher::DISP_SCALE;
  const int first = min_disparity * kScale;
  cv::Mat1w disparity(found.size(), kNoDisparity);
  for (int y = 0; y < found.rows; ++y) {
    for (int x = 0; x < found.cols; ++x) {
      if (found(y, x) < first) continue;
      disparity(y, x) =
          static_cast<std::uint16_t>((found(y, x) - first) * kDisparityScale / kScale);
    }
  }
  return disparity;
}

void extend_rows(cv::Mat1w& disparity) {
  constexpr int kHalf = kStereoBmWindow / 2;
  for (int y = 0; y < kHalf && disparity.rows > kStereoBmWindow; ++y) {
    disparity.row(kHalf).copyTo(disparity.row(y));
    disparity.row(disparity.rows - 1 - kHalf).copyTo(disparity.row(disparity.rows - 1 - y));
  }
}

}  // namespace fpga_stereo::tools
