// Sub-pixel accuracy on slanted planes, whose true disparities lie between whole pixels.
#include <gtest/gtest.h>

#include <cmath>

#include "core/reference_pipeline.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

struct Errors {
  double whole = 0, refined = 0, misprint = 0;  // RMS, px
  int count = 0;
};

/// Measures the errors of whole pixels, of the stage, and of offsets halved by the paper's
/// misprint.
Errors errors_on_plane(double a, double b, Parameters p, unsigned seed) {
  const cv::Size size(240, 80);
  p.disparity_range = 48;
  StereoGeometry geometry;
  geometry.image_size = size;
  const SlantedPair pair = slanted_pair(size, Texture(seed), a, b);
  ReferencePipeline pipeline;
  const Taps& taps =
      pipeline.process(pair.left, pair.right, identity_rectification(geometry, 0), p, 1);

  Errors errors;
  for (int y = 15; y < size.height - 15; ++y) {
    for (int x = p.disparity_range + 15; x < size.width - 15; ++x) {
      const int value = taps.disparity(y, x);
      if (value == kNoDisparity) continue;
      const double truth = a + b * x;
      const double whole = taps.selection.winner(y, x);
      const double half = naive::parabola_offset(taps.selection.around(y, x), 7, 20) / 32.0;
      errors.whole += std::pow(whole - truth, 2);
      errors.refined += std::pow(value / 32.0 - truth, 2);
      errors.misprint += std::pow(whole + half - truth, 2);
      ++errors.count;
    }
  }
  for (double* sum : {&errors.whole, &errors.refined, &errors.misprint}) {
    *sum = std::sqrt(*sum / errors.count);
  }
  return errors;
}

TEST(Slant, SubpixelIsCloserToThePlane) {
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    Parameters p = window_parameters();
    p.census_pattern = pattern;
    for (const double slope : {0.02, -0.03, 0.05, 0.08}) {
      const unsigned seed = 7;
      const double start = slope > 0 ? 6.3 : 20.7;
      const Errors e = errors_on_plane(start, slope, p, seed);
      SCOPED_TRACE(::testing::Message() << "slope " << slope << ", seed " << seed);
      EXPECT_GT(e.count, 5000);
      EXPECT_GT(e.whole, 0.25) << "rounding to whole pixels alone causes 0.29";
      EXPECT_LT(e.refined, e.misprint);
      EXPECT_LT(e.misprint, e.whole);
      EXPECT_LT(e.refined, 0.5 * e.whole);
    }
  }
}

// Measured: at most 0.055 px for sgm_build small at a slope of 0.08.
TEST(Slant, FitOfSemiGlobalMatchingIsCloseToThePlane) {
  for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
    Parameters p;
    p.sgm_build = build;
    for (const double slope : {0.0, 0.02, -0.03, 0.05, 0.08}) {
      const unsigned seed = 7;
      const double start = slope >= 0 ? 6.3 : 20.7;
      const Errors e = errors_on_plane(start, slope, p, seed);
      SCOPED_TRACE(::testing::Message()
                   << to_text(build) << ", slope " << slope << ", seed " << seed);
      EXPECT_GT(e.count, 8000);
      EXPECT_GT(e.whole, 0.25) << "rounding to whole pixels alone causes 0.29";
      EXPECT_LT(e.refined, 0.06);
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
