#include "fpga_stereo/core/rectification_cache.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

StereoCalibration calibration() {
  CameraCalibration left;
  left.width = 64;
  left.height = 48;
  left.distortion_model = "plumb_bob";
  left.K = {300, 0, 32, 0, 300, 24, 0, 0, 1};
  left.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  left.P = {300, 0, 32, 0, 0, 300, 24, 0, 0, 0, 1, 0};
  CameraCalibration right = left;
  right.P[3] = -30;
  return {left, right};
}

TEST(RectificationCache, KeepsTheRectificationUntilItsInputChanges) {
  RectificationCache cache;
  StereoCalibration input = calibration();
  const auto first = *cache.get(input, 0);
  EXPECT_EQ(*cache.get(input, 0), first);
  const auto shifted = *cache.get(input, 4);
  EXPECT_NE(shifted, first);
  EXPECT_EQ(shifted->min_disparity, 4);
  EXPECT_EQ(first->min_disparity, 0) << "users of the old one keep it";
  input.left.D = {-0.1, 0, 0, 0, 0};
  const auto distorted = *cache.get(input, 4);
  EXPECT_NE(distorted, shifted);
  EXPECT_EQ(*cache.get(input, 4), distorted);
}

TEST(RectificationCache, ReturnsTheErrorOfABadCalibrationAndRecovers) {
  RectificationCache cache;
  StereoCalibration bad = calibration();
  bad.right.P[3] = 0;
  ASSERT_FALSE(cache.get(bad, 0));
  EXPECT_EQ(cache.get(bad, 0).error().kind, ErrorKind::kCalibration);
  EXPECT_TRUE(cache.get(calibration(), 0));
}

}  // namespace
}  // namespace fpga_stereo::test
