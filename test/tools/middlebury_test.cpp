// The Middlebury evaluation, with counts determined by hand.
#include "support/middlebury.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr std::uint16_t kNone = kNoDisparity;

/// Returns a scene of one row with truth scale 4; all pixels are evaluated.
MiddleburyPair row_of_truth(const cv::Mat1b& truth) {
  MiddleburyPair pair;
  pair.scene = {"row", 4, 60, false};
  pair.truth = truth;
  for (cv::Mat1b& mask : pair.masks) mask = cv::Mat1b(truth.size(), std::uint8_t{255});
  return pair;
}

TEST(Score, MoreThanOnePixelIsBad) {
  // The truth is 10.25 px. An error of exactly 1 px is good, 1/32 px more is bad.
  const MiddleburyPair pair = row_of_truth((cv::Mat1b(1, 5) << 41, 41, 41, 41, 41));
  const cv::Mat1w disparity = (cv::Mat1w(1, 5) << 360, 361, 296, 295, 328);
  const Score s = score(pair, kAll, disparity, 0);
  EXPECT_EQ(s.evaluated, 5);
  EXPECT_EQ(s.valid, 5);
  EXPECT_EQ(s.bad, 2);
  EXPECT_DOUBLE_EQ(s.bad_of_all(), 40);
  EXPECT_EQ(score(pair, kAll, disparity - 96, 3).bad, 2);  // min_disparity is added
}

TEST(Score, HolesAndMasks) {
  MiddleburyPair pair = row_of_truth((cv::Mat1b(1, 5) << 40, 40, 40, 40, 40));
  pair.masks[kDiscontinuities] = (cv::Mat1b(1, 5) << 255, 255, 255, 255, 128);
  const cv::Mat1w disparity = (cv::Mat1w(1, 5) << 320, kNone, kNone, 0, 0);
  const Score s = score(pair, kDiscontinuities, disparity, 0);
  EXPECT_EQ(s.evaluated, 4);
  EXPECT_EQ(s.valid, 2);
  EXPECT_EQ(s.bad, 1);
  EXPECT_DOUBLE_EQ(s.bad_of_all(), 75);
  EXPECT_DOUBLE_EQ(s.bad_of_valid(), 50);
  EXPECT_DOUBLE_EQ(s.coverage(), 50);
}

TEST(Score, RmsOfGoodPixels) {
  // Errors of 0.75 px, -1 px, 0, then a bad pixel and a hole, which do not count.
  const MiddleburyPair pair = row_of_truth((cv::Mat1b(1, 5) << 41, 40, 40, 40, 40));
  const cv::Mat1w disparity = (cv::Mat1w(1, 5) << 352, 288, 320, 400, kNone);
  const double rms = std::sqrt((0.75 * 0.75 + 1) / 3);
  EXPECT_DOUBLE_EQ(score(pair, kNonOccluded, disparity, 0).rms_of_good(), rms);
  const cv::Mat1w shifted = (cv::Mat1w(1, 5) << 288, 224, 256, 336, kNone);
  EXPECT_DOUBLE_EQ(score(pair, kNonOccluded, shifted, 2).rms_of_good(), rms);
}

TEST(Score, NothingToEvaluate) {
  MiddleburyPair pair = row_of_truth((cv::Mat1b(1, 2) << 40, 40));
  pair.masks[kAll] = 0;
  const Score s = score(pair, kAll, cv::Mat1w(1, 2, kNone), 0);
  EXPECT_EQ(s.bad_of_all(), 0);
  EXPECT_EQ(s.bad_of_valid(), 0);
  EXPECT_EQ(s.coverage(), 0);
  EXPECT_EQ(s.rms_of_good(), 0);
}

TEST(ErrorPicture, Colours) {
  MiddleburyPair pair = row_of_truth((cv::Mat1b(1, 4) << 40, 40, 40, 40));
  pair.masks[kAll](0, 3) = 0;
  const cv::Mat1w disparity = (cv::Mat1w(1, 4) << 320, 0, kNone, 320);
  const auto same = [](const cv::Mat1b& a, const cv::Mat1b& b) {
    return cv::countNonZero(a != b) == 0;
  };
  EXPECT_TRUE(
      same(error_picture(pair, kAll, disparity, 0, true), (cv::Mat1b(1, 4) << 0, 255, 255, 128)));
  EXPECT_TRUE(
      same(error_picture(pair, kAll, disparity, 0, false), (cv::Mat1b(1, 4) << 0, 255, 128, 128)));
}

}  // namespace
}  // namespace fpga_stereo::tools
