#include "core/reference_pipeline.hpp"

#include <gtest/gtest.h>

#include "core/pipeline_rig.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

Parameters small_search() {
  Parameters p = window_parameters();
  p.disparity_range = 16;
  p.correlation_window_size = 7;
  p.census_window_size = 7;
  p.speckle_size = 12;
  return p;
}

/// Computes every stage by the naive model.
Taps naive_taps(const cv::Mat1b& left, const cv::Mat1b& right, const StereoRectification& r,
                const Parameters& p) {
  Taps t;
  t.left = naive::rectify(left, r.left.mesh);
  t.right = naive::rectify(right, r.right.mesh);
  t.left_bits = naive::census(t.left, p);
  t.right_bits = naive::census(t.right, p);
  t.selection = naive::select(naive::match(t.left_bits, t.right_bits, p));
  t.kept = naive::check(t.selection, p);
  t.refined = naive::subpixel(t.selection, t.kept, p);
  t.disparity = naive::speckle(t.refined, p);
  return t;
}

/// Compares stage by stage; a failure names the first stage that differs.
::testing::AssertionResult same(const Taps& expected, const Taps& actual, const Case& c) {
  auto result = test::same("rectify left", expected.left, actual.left, c);
  if (result) result = test::same("rectify right", expected.right, actual.right, c);
  if (result) result = test::same("census left", expected.left_bits, actual.left_bits, c);
  if (result) result = test::same("census right", expected.right_bits, actual.right_bits, c);
  if (result) result = test::same("select", expected.selection, actual.selection, c);
  if (result) result = test::same("check", expected.kept, actual.kept, c);
  if (result) result = test::same("subpixel", expected.refined, actual.refined, c);
  if (result) result = test::same("speckle", expected.disparity, actual.disparity, c);
  return result;
}

TEST(ReferencePipeline, StageNamesInDataOrder) {
  const std::vector<std::string> expected{"rectify", "census",   "match",  "select",
                                          "check",   "subpixel", "speckle"};
  EXPECT_EQ(std::vector<std::string>(kStageNames.begin(), kStageNames.end()), expected);
  EXPECT_STREQ(kStageNames[static_cast<std::size_t>(Stage::kMatch)], "match");
}

TEST(ReferencePipeline, EqualsTheNaiveModel) {
  unsigned seed = 1500;
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {5, 4}, {31, 17}, {64, 33}}) {
    for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
      Parameters p = small_search();
      p.census_pattern = pattern;
      const SlantedPair pair = textured_pair(size, ++seed);
      const StereoRectification r = random_rectification(size, seed);
      const Taps expected = naive_taps(pair.left, pair.right, r, p);
      ReferencePipeline pipeline;
      const Case c{p, seed, "textured"};
      ASSERT_TRUE(same(expected, pipeline.process(pair.left, pair.right, r, p, 1), c));
      const cv::Mat1b left = padded(pair.left, 1), right = padded(pair.right, 2);
      ASSERT_TRUE(same(expected, pipeline.process(left, right, r, p, 2), c)) << "padded";
    }
  }
}

TEST(ReferencePipeline, DefaultsEqualTheNaiveModel) {
  const cv::Size size(96, 24);
  const Parameters p = window_parameters();
  const SlantedPair pair = textured_pair(size, 3);
  ReferencePipeline pipeline;
  const StereoRectification r = identity_for(size);
  const Taps& taps = pipeline.process(pair.left, pair.right, r, p, 2);
  EXPECT_TRUE(same(naive_taps(pair.left, pair.right, r, p), taps, {p, 3, "textured"}));
  EXPECT_GT(cv::countNonZero(taps.disparity != kNoDisparity), 500)
      << "too few disparities to compare";
}

TEST(ReferencePipeline, EverySwitch) {
  const cv::Size size(48, 20);
  const SlantedPair pair = textured_pair(size, 4);
  const StereoRectification r = identity_for(size);
  ReferencePipeline pipeline;
  for (int switches = 0; switches < 16; ++switches) {
    Parameters p = small_search();
    p.left_right_check = (switches & 1) != 0;
    p.uniqueness_check = (switches & 2) != 0;
    p.subpixel = (switches & 4) != 0;
    p.speckle_size = (switches & 8) != 0 ? 30 : 0;
    const Taps& taps = pipeline.process(pair.left, pair.right, r, p, 1);
    ASSERT_TRUE(same(naive_taps(pair.left, pair.right, r, p), taps, {p, 4, "switches"}));
  }
}

TEST(ReferencePipeline, ExtremeImages) {
  const cv::Size size(30, 14);
  const Parameters p = small_search();
  const StereoRectification r = identity_for(size);
  ReferencePipeline pipeline;
  for (const NamedImage& left : extreme_images(size, 5)) {
    for (const NamedImage& right : extreme_images(size, 6)) {
      const Taps& taps = pipeline.process(left.image, right.image, r, p, 3);
      ASSERT_TRUE(same(naive_taps(left.image, right.image, r, p), taps,
                       {p, 5, left.name + " / " + right.name}));
    }
  }
}

TEST(ReferencePipeline, ThreadsAndRepetitionChangeNothing) {
  const cv::Size size(61, 37);
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    Parameters p = window_parameters();
    p.disparity_range = 32;
    p.census_pattern = pattern;
    p.speckle_size = 50;
    const SlantedPair pair = textured_pair(size, 7);
    const StereoRectification r = random_rectification(size, 7);
    ReferencePipeline one, many;
    const Taps& expected = one.process(pair.left, pair.right, r, p, 1);
    for (const int threads : {1, 2, 3, 7, 37, 200}) {
      for (int repetition = 0; repetition < 2; ++repetition) {
        const Case c{p, 7, std::to_string(threads) + " threads"};
        ASSERT_TRUE(same(expected, many.process(pair.left, pair.right, r, p, threads), c));
      }
    }
  }
}

TEST(ReferencePipeline, ForgetsEarlierFrames) {
  ReferencePipeline used;
  unsigned seed = 1600;
  for (const cv::Size size : {cv::Size(40, 30), {17, 41}, {1, 1}, {50, 12}}) {
    for (const int range : {32, 8}) {
      Parameters p = small_search();
      p.disparity_range = range;
      p.census_pattern = range == 8 ? CensusPattern::kFull : CensusPattern::kSparse;
      const SlantedPair pair = textured_pair(size, ++seed);
      const StereoRectification r = identity_for(size);
      ReferencePipeline fresh;
      const Taps& expected = fresh.process(pair.left, pair.right, r, p, 2);
      ASSERT_TRUE(same(expected, used.process(pair.left, pair.right, r, p, 2), {p, seed, "used"}));
    }
  }
}

TEST(ReferencePipeline, DoesNotChangeItsInputs) {
  const SlantedPair pair = textured_pair({40, 30}, 8);
  const cv::Mat1b left = pair.left.clone(), right = pair.right.clone();
  ReferencePipeline pipeline;
  pipeline.process(left, right, identity_for(left.size()), small_search(), 2);
  EXPECT_TRUE(test::same("left", pair.left, left));
  EXPECT_TRUE(test::same("right", pair.right, right));
}

// Shifting the right image by m px adds m px of disparity, which the search with min_disparity m
// finds as before.
TEST(ReferencePipeline, MinDisparityFindsAShiftedImage) {
  const cv::Size size(70, 24);
  for (const int minimum : {-9, 5, 20}) {
    Parameters p = small_search();
    const SlantedPair pair = textured_pair(size, 9);
    cv::Mat1b shifted_right(size, std::uint8_t{0}), visible(size, std::uint8_t{0});
    for (int x = 0; x < size.width; ++x) {
      if (x + minimum < 0 || x + minimum >= size.width) continue;
      pair.right.col(x + minimum).copyTo(shifted_right.col(x));
      pair.right.col(x + minimum).copyTo(visible.col(x + minimum));
    }
    ReferencePipeline plain, shifted;
    const Taps& expected = plain.process(pair.left, visible, identity_for(size), p, 1);
    p.min_disparity = minimum;
    const Taps& taps = shifted.process(pair.left, shifted_right, identity_for(size, minimum), p, 2);
    ASSERT_TRUE(same(expected, taps, {p, 9, "min_disparity"}));
    EXPECT_GT(cv::countNonZero(taps.disparity != kNoDisparity), 300);
  }
}

TEST(ReferencePipeline, FindsThePlane) {
  const cv::Size size(120, 60);
  const Parameters p = small_search();
  const SlantedPair pair = textured_pair(size, 10);  // 3.2 + 0.05 x
  ReferencePipeline pipeline;
  const Taps& taps = pipeline.process(pair.left, pair.right, identity_for(size), p, 2);
  int close = 0;
  int valid = 0;
  for (int y = 10; y < 50; ++y) {
    for (int x = 30; x < 110; ++x) {
      if (taps.disparity(y, x) == kNoDisparity) continue;
      ++valid;
      if (std::abs(taps.disparity(y, x) / 32.0 - (3.2 + 0.05 * x)) < 0.5) ++close;
    }
  }
  EXPECT_GT(valid, 2000);
  EXPECT_GT(close, valid * 98 / 100);
}

TEST(ReferencePipeline, TimesOfEveryStage) {
  ReferencePipeline pipeline;
  const SlantedPair pair = textured_pair({40, 30}, 11);
  const Taps& taps =
      pipeline.process(pair.left, pair.right, identity_for({40, 30}), small_search(), 2);
  for (const double ms : taps.ms) EXPECT_GT(ms, 0);
}

}  // namespace
}  // namespace fpga_stereo::test
