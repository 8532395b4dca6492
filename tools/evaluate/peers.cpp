#include "evaluate/peers.hpp"

#include "core/stages.hpp"
#include "support/opencv_matcher.hpp"

namespace fpga_stereo::tools {

cv::Mat1w peer_disparity(const std::string& peer, const cv::Mat& left, const cv::Mat& right,
                         int disparity_range) {
  const bool bm = peer == "StereoBM";
  const auto matcher = make_opencv_matcher(bm ? OpencvMatcher::kBm : OpencvMatcher::kSgbm,
                                           (disparity_range + 15) / 16 * 16);
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
  if (bm) {
    // StereoBM computes nothing for half a window at the top and bottom. Copy the nearest row, so
    // that these rows do not all count as bad.
    constexpr int kHalf = kStereoBmWindow / 2;
    for (int y = 0; y < kHalf && disparity.rows > kStereoBmWindow; ++y) {
      disparity.row(kHalf).copyTo(disparity.row(y));
      disparity.row(disparity.rows - 1 - kHalf).copyTo(disparity.row(disparity.rows - 1 - y));
    }
  }
  return disparity;
}

}  // namespace fpga_stereo::tools
