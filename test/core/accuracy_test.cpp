// Accuracy of matching on real images: the Middlebury stereo evaluation, version 2.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reference_pipeline.hpp"
#include "support/data_test.hpp"

namespace fpga_stereo::test {
namespace {

using Accuracy = DataTest;

/// Returns the percentage of pixels in `mask` whose disparity is off by more than 1 px.
double bad_percent(const cv::Mat1w& disparity, const cv::Mat1f& truth, const cv::Mat1b& mask) {
  int bad = 0;
  int count = 0;
  for (int y = 0; y < mask.rows; ++y) {
    for (int x = 0; x < mask.cols; ++x) {
      if (mask(y, x) != 255) continue;
      ++count;
      const double value = disparity(y, x) / static_cast<double>(kDisparityScale);
      if (std::abs(value - static_cast<double>(truth(y, x))) > 1.0) ++bad;
    }
  }
  return 100.0 * bad / count;
}

/// Returns the average over four pairs and three regions. A pixel without a disparity is bad.
double average_bad_percent(Parameters p) {
  double sum = 0;
  for (const std::string& name : middlebury_names()) {
    const MiddleburyPair pair = middlebury_pair(name);
    p.disparity_range = pair.disparity_range;
    StereoGeometry geometry;
    geometry.image_size = pair.left.size();
    ReferencePipeline pipeline;
    const Taps& taps =
        pipeline.process(pair.left, pair.right, identity_rectification(geometry, 0), p, 1);
    for (const cv::Mat1b& mask : {pair.nonocc, pair.all, pair.disc}) {
      sum += bad_percent(taps.disparity, pair.truth, mask);
    }
  }
  return sum / 12;
}

/// Window matching without anything that drops disparities, in whole pixels.
Parameters dense_window_parameters(CensusPattern pattern) {
  Parameters p = window_parameters();
  p.census_pattern = pattern;
  p.left_right_check = p.uniqueness_check = p.subpixel = false;
  p.speckle_size = 0;
  return p;
}

TEST_F(Accuracy, DenseSparsePattern) {
  const double average = average_bad_percent(dense_window_parameters(CensusPattern::kSparse));
  RecordProperty("average_bad_percent", std::to_string(average));
  EXPECT_LE(average, 14.8);
  EXPECT_GT(average, 5.0) << "too good for local matching: is the evaluation wrong?";
}

TEST_F(Accuracy, DenseFullPattern) {
  const double average = average_bad_percent(dense_window_parameters(CensusPattern::kFull));
  RecordProperty("average_bad_percent", std::to_string(average));
  EXPECT_LE(average, 15.2);
  EXPECT_GT(average, 5.0) << "too good for local matching: is the evaluation wrong?";
}

// The definition fixes every bit, so these figures change with it and with nothing else.
TEST_F(Accuracy, DenseSemiGlobalMatching) {
  Parameters p;
  p.dense = true;
  EXPECT_NEAR(average_bad_percent(p), 5.98, 0.005);
  p.sgm_build = SgmBuild::kSmall;
  EXPECT_NEAR(average_bad_percent(p), 6.74, 0.005);
}

TEST_F(Accuracy, DefaultsOnPixelsThatBothCamerasSee) {
  double bad = 0, density = 0;
  for (const std::string& name : middlebury_names()) {
    const MiddleburyPair pair = middlebury_pair(name);
    Parameters p;
    p.disparity_range = pair.disparity_range;
    StereoGeometry geometry;
    geometry.image_size = pair.left.size();
    ReferencePipeline pipeline;
    const cv::Mat1w disparity =
        pipeline.process(pair.left, pair.right, identity_rectification(geometry, 0), p, 1)
            .disparity;
    const cv::Mat1b visible = pair.nonocc == 255;
    const cv::Mat1b valid = visible & (disparity != kNoDisparity);
    density += 100.0 * cv::countNonZero(valid) / cv::countNonZero(visible) / 4;
    bad += bad_percent(disparity, pair.truth, valid) / 4;
  }
  EXPECT_NEAR(density, 94.30, 0.005);
  EXPECT_NEAR(bad, 2.12, 0.005);
}

}  // namespace
}  // namespace fpga_stereo::test
