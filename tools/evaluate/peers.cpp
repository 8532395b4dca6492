#include "evaluate/peers.hpp"

#include <opencv2/calib3d.hpp>

#include "fpga_stereo/core/stages.hpp"

namespace fpga_stereo::tools {

cv::Mat1w peer_disparity(const std::string& peer, const cv::Mat& left, const cv::Mat& right,
                         int disparity_range) {
  constexpr int kWindow = 15, kBlock = 5, kUniqueness = 15;
  const int range = (disparity_range + 15) / 16 * 16;
  cv::Ptr<cv::StereoMatcher> matcher;
  if (peer == "StereoBM") {
    const auto bm = cv::StereoBM::create(range, kWindow);
    bm->setUniquenessRatio(kUniqueness);
    matcher = bm;
  } else {
    // The penalties that OpenCV's manual recommends.
    matcher = cv::StereoSGBM::create(0, range, kBlock, 8 * kBlock * kBlock, 32 * kBlock * kBlock, 1,
                                     31, kUniqueness);
  }
  matcher->setDisp12MaxDiff(1);
  matcher->setSpeckleWindowSize(100);
  matcher->setSpeckleRange(4);
  cv::Mat1s found;
  matcher->compute(left, right, found);
  cv::Mat1w disparity(found.size(), kNoDisparity);
  for (int y = 0; y < found.rows; ++y) {
    for (int x = 0; x < found.cols; ++x) {
      if (found(y, x) < 0) continue;
      disparity(y, x) =
          static_cast<std::uint16_t>(found(y, x) * kDisparityScale / cv::StereoMatcher::DISP_SCALE);
    }
  }
  if (peer == "StereoBM") {
    // It leaves out half a window above and below, which would count against it.
    constexpr int kHalf = kWindow / 2;
    for (int y = 0; y < kHalf && disparity.rows > kWindow; ++y) {
      disparity.row(kHalf).copyTo(disparity.row(y));
      disparity.row(disparity.rows - 1 - kHalf).copyTo(disparity.row(disparity.rows - 1 - y));
    }
  }
  return disparity;
}

}  // namespace fpga_stereo::tools
