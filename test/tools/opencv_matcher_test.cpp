// The disparities of OpenCV's matchers in our units.
#include "support/opencv_matcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "fpga_stereo/core/spec.hpp"
#include "programs.hpp"

namespace fpga_stereo::tools {
namespace {

class OpencvMatchers : public testing::TestWithParam<OpencvMatcher> {};

TEST_P(OpencvMatchers, CountFromTheSmallestDisparity) {
  for (const int min_disparity : {0, 16}) {
    const NoisePair pair = noise_pair({160, 60}, min_disparity + 20);
    const cv::Mat1w disparity =
        opencv_disparity(GetParam(), pair.left, pair.right, min_disparity, 30);
    // Nothing is computed where the range of 32 reaches beyond the right image.
    const cv::Mat1w computed = disparity.colRange(70, 140).rowRange(10, 50);
    constexpr int kExpected = 20 * kDisparityScale;
    const cv::Mat near = (computed >= kExpected - 16) & (computed <= kExpected + 16);
    EXPECT_GT(cv::countNonZero(near), static_cast<int>(computed.total()) * 9 / 10);
    const cv::Mat valid = disparity != kNoDisparity;
    EXPECT_EQ(cv::countNonZero(valid & (disparity >= 32 * kDisparityScale)), 0);
    EXPECT_EQ(cv::countNonZero(valid.colRange(0, 16)), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, OpencvMatchers, testing::ValuesIn(kOpencvMatchers),
                         [](const auto& test) { return std::string(to_text(test.param)); });

TEST(ExtendRows, CopiesTheNearestRow) {
  cv::Mat1w disparity(20, 1, kNoDisparity);
  for (int y = 7; y < 13; ++y) disparity(y, 0) = static_cast<std::uint16_t>(y);
  extend_rows(disparity);
  for (int y = 0; y < 20; ++y) EXPECT_EQ(disparity(y, 0), std::clamp(y, 7, 12)) << y;
}

}  // namespace
}  // namespace fpga_stereo::tools
