#include "core/reference_pipeline.hpp"

#include <gtest/gtest.h>

#include <set>

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

/// The same search with every algorithm that computes other bits, each without and with dense.
std::vector<Parameters> small_searches() {
  std::vector<Parameters> all(4, small_search());
  all[1].census_pattern = CensusPattern::kFull;
  all[2].stereo_algorithm = all[3].stereo_algorithm = StereoAlgorithm::kSgm;
  all[3].sgm_build = SgmBuild::kSmall;
  for (std::size_t i = 0; i < 4; ++i) {
    all.push_back(all[i]);
    all.back().dense = true;
  }
  return all;
}

/// Returns the smallest and the largest value of a parameter, or all its choices.
std::vector<std::string> limits(const ParameterInfo& info) {
  if (std::holds_alternative<bool Parameters::*>(info.member)) return {"false", "true"};
  if (!info.choices.empty()) return info.choices;
  return {std::to_string(static_cast<int>(info.min)), std::to_string(static_cast<int>(info.max))};
}

/// Returns parameters with any allowed values, but for a small search range.
Parameters random_parameters(cv::RNG& rng) {
  Parameters p;
  for (const ParameterInfo& info : parameter_table()) {
    std::string text;
    if (std::holds_alternative<bool Parameters::*>(info.member)) {
      text = rng.uniform(0, 2) == 0 ? "false" : "true";
    } else if (!info.choices.empty()) {
      text = info.choices[rng.uniform(0, static_cast<int>(info.choices.size()))];
    } else {
      const int max = static_cast<int>(info.name == "disparity_range" ? 40 : info.max);
      const int min = static_cast<int>(info.min);
      text = std::to_string(min + info.step * rng.uniform(0, (max - min) / info.step + 1));
    }
    const Status set = set_parameter(p, info.name, text);
    CV_Assert(set);
  }
  p.speckle_size %= 40;
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
  const bool is_sgm = p.stereo_algorithm == StereoAlgorithm::kSgm;
  if (is_sgm) {
    const naive::Sums costs = naive::cost(t.left, t.right, t.left_bits, t.right_bits, p);
    t.selection = naive::select(naive::aggregate(t.left, costs, p));
  } else {
    t.selection = naive::select(naive::match(t.left_bits, t.right_bits, p));
  }
  t.kept = naive::check(t.selection, p);
  t.refined = is_sgm ? naive::fit_subpixel(t.left_bits, t.right_bits, t.selection, t.kept, p)
                     : naive::subpixel(t.selection, t.kept, p);
  t.filtered = t.disparity = naive::speckle(t.refined, p);
  if (p.dense) {
    t.filled = naive::fill(t.filtered);
    t.disparity = naive::median(naive::masked_median(t.left, t.filled, p));
  }
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
  if (result) result = test::same("speckle", expected.filtered, actual.filtered, c);
  if (result && c.parameters.dense) {
    result = test::same("fill", expected.filled, actual.filled, c);
  }
  if (result) result = test::same("result", expected.disparity, actual.disparity, c);
  return result;
}

TEST(ReferencePipeline, StageNamesInDataOrder) {
  const std::vector<std::string> expected{"rectify",   "census", "match", "cost",
                                          "aggregate", "select", "check", "subpixel",
                                          "speckle",   "fill",   "median"};
  EXPECT_EQ(std::vector<std::string>(kStageNames.begin(), kStageNames.end()), expected);
  EXPECT_STREQ(kStageNames[static_cast<std::size_t>(Stage::kMatch)], "match");
}

TEST(ReferencePipeline, EqualsTheNaiveModel) {
  unsigned seed = 1500;
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {5, 4}, {31, 17}, {64, 33}}) {
    for (const Parameters& p : small_searches()) {
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
  Parameters dense;
  dense.dense = true;
  for (const Parameters& p : {window_parameters(), Parameters(), dense}) {
    const SlantedPair pair = textured_pair(size, 3);
    ReferencePipeline pipeline;
    const StereoRectification r = identity_for(size);
    const Taps& taps = pipeline.process(pair.left, pair.right, r, p, 2);
    EXPECT_TRUE(same(naive_taps(pair.left, pair.right, r, p), taps, {p, 3, "textured"}));
    EXPECT_GT(cv::countNonZero(taps.disparity != kNoDisparity), 500)
        << "too few disparities to compare";
  }
}

TEST(ReferencePipeline, EveryParameterAtItsLimits) {
  const cv::Size size(40, 11);
  const SlantedPair pair = textured_pair(size, 12);
  ReferencePipeline pipeline;
  for (const Parameters& search : small_searches()) {
    for (const ParameterInfo& info : parameter_table()) {
      for (const std::string& text : limits(info)) {
        Parameters p = search;
        ASSERT_TRUE(set_parameter(p, info.name, text)) << info.name << " = " << text;
        const StereoRectification r = identity_for(size, p.min_disparity);
        const Taps& taps = pipeline.process(pair.left, pair.right, r, p, 1);
        ASSERT_TRUE(same(naive_taps(pair.left, pair.right, r, p), taps, {p, 12, info.name}));
      }
    }
  }
}

TEST(ReferencePipeline, RandomParameters) {
  ReferencePipeline pipeline;
  for (unsigned seed = 1700; seed < 1800; ++seed) {
    cv::RNG rng(seed);
    const cv::Size size(rng.uniform(1, 50), rng.uniform(1, 20));
    const Parameters p = random_parameters(rng);
    const SlantedPair textured = textured_pair(size, seed);
    const bool is_noise = rng.uniform(0, 4) == 0;
    const cv::Mat1b left = is_noise ? random_image(size, seed) : textured.left;
    const cv::Mat1b right = is_noise ? random_image(size, seed + 1) : textured.right;
    const StereoRectification r = random_rectification(size, seed);
    const Taps& taps = pipeline.process(left, right, r, p, rng.uniform(1, 8));
    ASSERT_TRUE(
        same(naive_taps(left, right, r, p), taps, {p, seed, is_noise ? "noise" : "texture"}));
  }
}

TEST(ReferencePipeline, EverySwitch) {
  const cv::Size size(48, 20);
  const SlantedPair pair = textured_pair(size, 4);
  const StereoRectification r = identity_for(size);
  ReferencePipeline pipeline;
  for (Parameters p : small_searches()) {
    for (int switches = 0; switches < 16; ++switches) {
      p.left_right_check = (switches & 1) != 0;
      p.uniqueness_check = (switches & 2) != 0;
      p.subpixel = (switches & 4) != 0;
      p.speckle_size = (switches & 8) != 0 ? 30 : 0;
      const Taps& taps = pipeline.process(pair.left, pair.right, r, p, 1);
      ASSERT_TRUE(same(naive_taps(pair.left, pair.right, r, p), taps, {p, 4, "switches"}));
    }
  }
}

TEST(ReferencePipeline, ExtremeImages) {
  const cv::Size size(30, 14);
  const StereoRectification r = identity_for(size);
  ReferencePipeline pipeline;
  for (const Parameters& p : small_searches()) {
    for (const NamedImage& left : extreme_images(size, 5)) {
      for (const NamedImage& right : extreme_images(size, 6)) {
        const Taps& taps = pipeline.process(left.image, right.image, r, p, 3);
        ASSERT_TRUE(same(naive_taps(left.image, right.image, r, p), taps,
                         {p, 5, left.name + " / " + right.name}));
      }
    }
  }
}

TEST(ReferencePipeline, ThreadsAndRepetitionChangeNothing) {
  const cv::Size size(61, 37);
  for (Parameters p : small_searches()) {
    p.disparity_range = 32;
    p.speckle_size = 50;
    const SlantedPair pair = textured_pair(size, 7);
    const StereoRectification r = random_rectification(size, 7);
    ReferencePipeline one, many;
    const Taps& expected = one.process(pair.left, pair.right, r, p, 1);
    for (const int threads : {1, 2, 3, 5, 7, 37, 200}) {
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
    for (Parameters p : small_searches()) {  // they take turns, and so do two search ranges
      p.disparity_range = p.dense ? 8 : 32;
      const SlantedPair pair = textured_pair(size, ++seed);
      const StereoRectification r = identity_for(size);
      ReferencePipeline fresh;
      const Taps& expected = fresh.process(pair.left, pair.right, r, p, 2);
      const Taps& taps = used.process(pair.left, pair.right, r, p, 2);
      ASSERT_TRUE(same(expected, taps, {p, seed, "used"}));
      ASSERT_EQ(taps.filled.empty(), !p.dense);
    }
  }
}

TEST(ReferencePipeline, DoesNotChangeItsInputs) {
  const SlantedPair pair = textured_pair({40, 30}, 8);
  const cv::Mat1b left = pair.left.clone(), right = pair.right.clone();
  ReferencePipeline pipeline;
  for (const Parameters& p : small_searches()) {
    pipeline.process(left, right, identity_for(left.size()), p, 2);
    EXPECT_TRUE(test::same("left", pair.left, left));
    EXPECT_TRUE(test::same("right", pair.right, right));
  }
}

// Shifting the right image by m px adds m px of disparity, which the search with min_disparity m
// finds as before.
TEST(ReferencePipeline, MinDisparityFindsAShiftedImage) {
  const cv::Size size(70, 24);
  const SlantedPair pair = textured_pair(size, 9);
  for (const int minimum : {-9, 5, 20}) {
    cv::Mat1b shifted_right(size, std::uint8_t{0}), visible(size, std::uint8_t{0});
    for (int x = 0; x < size.width; ++x) {
      if (x + minimum < 0 || x + minimum >= size.width) continue;
      pair.right.col(x + minimum).copyTo(shifted_right.col(x));
      pair.right.col(x + minimum).copyTo(visible.col(x + minimum));
    }
    for (Parameters p : small_searches()) {
      ReferencePipeline plain, shifted;
      const Taps& expected = plain.process(pair.left, visible, identity_for(size), p, 1);
      p.min_disparity = minimum;
      const Taps& taps =
          shifted.process(pair.left, shifted_right, identity_for(size, minimum), p, 2);
      ASSERT_TRUE(same(expected, taps, {p, 9, "min_disparity"}));
      EXPECT_GT(cv::countNonZero(taps.disparity != kNoDisparity), 300);
    }
  }
}

TEST(ReferencePipeline, FindsThePlane) {
  const cv::Size size(120, 60);
  const SlantedPair pair = textured_pair(size, 10);  // 3.2 + 0.05 x
  for (const Parameters& p : small_searches()) {
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
    const Case c{p, 10, "plane"};
    EXPECT_GT(valid, 2000) << c;
    EXPECT_GT(close, valid * 98 / 100) << c;
  }
}

TEST(ReferencePipeline, DenseGivesEveryPixelADisparity) {
  const cv::Size size(60, 40);
  const SlantedPair pair = textured_pair(size, 13);
  for (const Parameters& p : small_searches()) {
    ReferencePipeline pipeline;
    const Taps& taps = pipeline.process(pair.left, pair.right, identity_for(size), p, 2);
    const int missing = cv::countNonZero(taps.disparity == kNoDisparity);
    const Case c{p, 13, "textured"};
    EXPECT_EQ(missing == 0, p.dense) << missing << "; " << c;
    EXPECT_GT(cv::countNonZero(taps.filtered == kNoDisparity), 100) << c;
    EXPECT_EQ(taps.filled.empty(), !p.dense) << c;
  }
}

TEST(ReferencePipeline, TimesOfEveryStage) {
  const SlantedPair pair = textured_pair({40, 30}, 11);
  for (const Parameters& p : small_searches()) {
    const bool is_sgm = p.stereo_algorithm == StereoAlgorithm::kSgm;
    std::set<Stage> unused{Stage::kMatch};
    if (!is_sgm) unused = {Stage::kCost, Stage::kAggregate};
    if (!p.dense) unused.insert({Stage::kFill, Stage::kMedian});
    ReferencePipeline pipeline;
    const Taps& taps = pipeline.process(pair.left, pair.right, identity_for({40, 30}), p, 2);
    for (int stage = 0; stage < kNumStages; ++stage) {
      const double ms = taps.ms[static_cast<std::size_t>(stage)];
      EXPECT_EQ(ms > 0, unused.count(static_cast<Stage>(stage)) == 0)
          << kStageNames[static_cast<std::size_t>(stage)] << ": " << ms << " ms";
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
