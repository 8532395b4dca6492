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

/// Returns the average over four pairs and three regions, for dense disparities in whole pixels.
double average_bad_percent(CensusPattern pattern) {
  double sum = 0;
  for (const std::string& name : middlebury_names()) {
    const MiddleburyPair pair = middlebury_pair(name);
    Parameters p = window_parameters();
    p.census_pattern = pattern;
    p.disparity_range = pair.disparity_range;
    p.left_right_check = p.uniqueness_check = p.subpixel = false;
    p.speckle_size = 0;
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

TEST_F(Accuracy, DenseSparsePattern) {
  const double average = average_bad_percent(CensusPattern::kSparse);
  RecordProperty("average_bad_percent", std::to_string(average));
  EXPECT_LE(average, 14.8);
  EXPECT_GT(average, 5.0) << "too good for local matching: is the evaluation wrong?";
}

TEST_F(Accuracy, DenseFullPattern) {
  const double average = average_bad_percent(CensusPattern::kFull);
  RecordProperty("average_bad_percent", std::to_string(average));
  EXPECT_LE(average, 15.2);
  EXPECT_GT(average, 5.0) << "too good for local matching: is the evaluation wrong?";
}

}  // namespace
}  // namespace fpga_stereo::test
