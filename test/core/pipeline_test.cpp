// Compares the pipeline with the reference on every target of this machine.
#include "fpga_stereo/core/pipeline.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/pipeline_rig.hpp"
#include "core/reference_pipeline.hpp"
#include "fpga_stereo/core/target.hpp"
#include "support/compare.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

class Pipelines : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(choose_target(GetParam())); }
  void TearDown() override { ASSERT_TRUE(choose_target(targets().front())); }

  ::testing::AssertionResult equal(const cv::Mat1b& left, const cv::Mat1b& right,
                                   const StereoRectification& r, const Case& c, int threads = 1) {
    const Taps& expected = reference_.process(left, right, r, c.parameters, 1);
    const DisparityFrame& actual = pipeline_.process(left, right, r, c.parameters, threads);
    valid_ += cv::countNonZero(actual.disparity != kNoDisparity);
    auto result = same("left", expected.left, actual.left, c);
    if (result) result = same("right", expected.right, actual.right, c);
    if (result) result = same("disparity", expected.disparity, actual.disparity, c);
    return result;
  }
  /// Compares on a textured pair with a random mesh, and with one that moves nothing.
  ::testing::AssertionResult equal_textured(cv::Size size, const Parameters& p, unsigned seed) {
    const SlantedPair pair = textured_pair(size, seed);
    auto result =
        equal(pair.left, pair.right, random_rectification(size, seed), {p, seed, "textured"});
    if (!result) return result;
    return equal(padded(pair.left, 1), padded(pair.right, 2), identity_for(size),
                 {p, seed, "padded"}, 2);
  }
  int valid_ = 0;  // disparities compared so far

 private:
  ReferencePipeline reference_;
  Pipeline pipeline_;  // used for all sizes and parameters: no frame may depend on an earlier one
};

const std::vector<cv::Size>& sizes_from_one_pixel() {
  static const std::vector<cv::Size> sizes{
      {1, 1},   {1, 9},   {9, 1},   {7, 4},   {8, 8},    {15, 30}, {16, 3},   {17, 41}, {31, 17},
      {33, 26}, {63, 12}, {64, 33}, {65, 20}, {100, 11}, {127, 9}, {129, 40}, {320, 24}};
  return sizes;
}

const std::vector<int>& ranges() {
  static const std::vector<int> values{8,  12, 16, 20,  28,  32,  36,  60,
                                       64, 68, 96, 100, 128, 160, 252, 256};
  return values;
}

TEST_P(Pipelines, EverySizeFromOnePixel) {
  unsigned seed = 2000;
  for (const cv::Size size : sizes_from_one_pixel()) {
    Parameters p = window_parameters();
    p.disparity_range = 32;
    p.correlation_window_size = 7;
    p.speckle_size = 12;
    ASSERT_TRUE(equal_textured(size, p, ++seed));
  }
  EXPECT_GT(valid_, 1000);
}

TEST_P(Pipelines, EveryRange) {
  const cv::Size size(150, 12);
  const SlantedPair pair = textured_pair(size, 8);
  for (const int range : ranges()) {
    Parameters p = window_parameters();
    p.disparity_range = range;
    p.speckle_size = 20;
    ASSERT_TRUE(equal(pair.left, pair.right, random_rectification(size, 8), {p, 8, "range"}, 3));
  }
  EXPECT_GT(valid_, 1000);
}

TEST_P(Pipelines, EveryWindowAndPattern) {
  const cv::Size size(90, 30);
  const SlantedPair pair = textured_pair(size, 9);
  for (int correlation = 5; correlation <= 21; correlation += 2) {
    for (int census = 5; census <= 11; census += 2) {
      for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
        Parameters p = window_parameters();
        p.disparity_range = 24;
        p.correlation_window_size = correlation;
        p.census_window_size = census;
        p.census_pattern = pattern;
        p.speckle_size = 20;
        ASSERT_TRUE(equal(pair.left, pair.right, identity_for(size), {p, 9, "windows"}, 2));
      }
    }
  }
  EXPECT_GT(valid_, 1000);
}

TEST_P(Pipelines, EverySwitchAndThreshold) {
  const cv::Size size(80, 40);
  const SlantedPair pair = textured_pair(size, 10);
  for (int switches = 0; switches < 16; ++switches) {
    for (const double ratio : {0.0, 12.5, 100.0}) {
      Parameters p = window_parameters();
      p.disparity_range = 32;
      p.left_right_check = (switches & 1) != 0;
      p.uniqueness_check = (switches & 2) != 0;
      p.subpixel = (switches & 4) != 0;
      p.speckle_size = (switches & 8) != 0 ? 30 : 0;
      p.uniqueness_ratio = ratio;
      p.disp12MaxDiff = switches % 3 * 2;
      p.speckle_range = switches % 4 * 10;
      ASSERT_TRUE(equal(pair.left, pair.right, identity_for(size), {p, 10, "switches"}));
    }
  }
}

TEST_P(Pipelines, ExtremeImages) {
  const cv::Size size(70, 26);
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    Parameters p = window_parameters();
    p.disparity_range = 32;
    p.correlation_window_size = 21;  // the largest sums
    p.census_pattern = pattern;
    p.speckle_size = 5;
    for (const NamedImage& left : extreme_images(size, 5)) {
      for (const NamedImage& right : extreme_images(size, 6)) {
        const Case c{p, 5, left.name + " / " + right.name};
        ASSERT_TRUE(equal(left.image, right.image, identity_for(size), c, 2));
      }
    }
  }
}

TEST_P(Pipelines, MeshesThatLeaveTheImage) {
  const cv::Size size(100, 40);
  const SlantedPair pair = textured_pair(size, 11);
  Parameters p = window_parameters();
  p.disparity_range = 16;
  for (const int max_units : {0, 128, 2000, 32767}) {
    ASSERT_TRUE(equal(pair.left, pair.right, random_rectification(size, 11, max_units + 1),
                      {p, 11, "mesh"}));
  }
}

TEST_P(Pipelines, ThreadsChangeNothing) {
  const cv::Size size(61, 37);
  const SlantedPair pair = textured_pair(size, 7);
  Parameters p = window_parameters();
  p.disparity_range = 32;
  p.speckle_size = 50;
  for (const int threads : {1, 2, 3, 7, 37, 200}) {
    const Case c{p, 7, std::to_string(threads) + " threads"};
    ASSERT_TRUE(equal(pair.left, pair.right, random_rectification(size, 7), c, threads));
  }
}

TEST_P(Pipelines, SgmOfEverySizeFromOnePixel) {
  unsigned seed = 2100;
  for (const cv::Size size : sizes_from_one_pixel()) {
    for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
      Parameters p;
      p.disparity_range = 32;
      p.sgm_build = build;
      p.dense = size.width % 2 == 0;
      p.speckle_size = 12;
      ASSERT_TRUE(equal_textured(size, p, ++seed));
    }
  }
  EXPECT_GT(valid_, 1000);
}

TEST_P(Pipelines, SgmOfEveryRange) {
  const cv::Size size(150, 20);
  const SlantedPair pair = textured_pair(size, 8);
  for (const int range : ranges()) {
    for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
      Parameters p;
      p.disparity_range = range;
      p.sgm_build = build;
      p.speckle_size = 20;
      ASSERT_TRUE(equal(pair.left, pair.right, random_rectification(size, 8), {p, 8, "range"}, 3));
    }
  }
  EXPECT_GT(valid_, 1000);
}

TEST_P(Pipelines, DenseWithEverySwitchAndAlgorithm) {
  const cv::Size size(80, 40);
  const SlantedPair pair = textured_pair(size, 10);
  for (Parameters p : {Parameters(), window_parameters()}) {
    for (int switches = 0; switches < 16; ++switches) {
      p.disparity_range = 32;
      p.dense = true;
      p.left_right_check = (switches & 1) != 0;
      p.uniqueness_check = (switches & 2) != 0;
      p.subpixel = (switches & 4) != 0;
      p.speckle_size = (switches & 8) != 0 ? 30 : 0;
      p.median_difference = switches * 17;
      ASSERT_TRUE(equal(pair.left, pair.right, identity_for(size), {p, 10, "switches"}));
    }
  }
}

TEST_P(Pipelines, SgmOfExtremeImages) {
  const cv::Size size(70, 26);
  Parameters p;
  p.disparity_range = 32;
  p.speckle_size = 5;
  for (const NamedImage& left : extreme_images(size, 5)) {
    for (const NamedImage& right : extreme_images(size, 6)) {
      p.dense = !p.dense;
      const Case c{p, 5, left.name + " / " + right.name};
      ASSERT_TRUE(equal(left.image, right.image, identity_for(size), c, 2));
    }
  }
}

TEST_P(Pipelines, ThreadsChangeNothingInSgm) {
  const cv::Size size(61, 77);
  const SlantedPair pair = textured_pair(size, 7);
  Parameters p;
  p.disparity_range = 32;
  for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
    p.sgm_build = build;
    for (const int threads : {1, 2, 3, 5, 7, 37, 200}) {
      p.dense = !p.dense;
      const Case c{p, 7, std::to_string(threads) + " threads"};
      ASSERT_TRUE(equal(pair.left, pair.right, random_rectification(size, 7), c, threads));
    }
  }
}

TEST_P(Pipelines, AlgorithmsTakeTurns) {
  const cv::Size size(90, 30);
  const SlantedPair pair = textured_pair(size, 14);
  for (const int range : {64, 32, 64}) {
    for (Parameters p : {Parameters(), window_parameters(), Parameters()}) {
      p.disparity_range = range;
      p.dense = range == 32;
      ASSERT_TRUE(equal(pair.left, pair.right, identity_for(size), {p, 14, "turns"}, 2));
    }
  }
}

TEST_P(Pipelines, RectifiesColorLikeTheReference) {
  for (const cv::Size size : {cv::Size(1, 1), {5, 7}, {64, 20}, {101, 33}}) {
    for (const int max_units : {100, 3000}) {
      const cv::Mat3b raw = random_color_image(size, 12);
      const StereoRectification r = random_rectification(size, 12, max_units);
      cv::Mat expected, actual;
      rectify(raw, r.left.mesh, cv::Range::all(), expected);
      rectify_image(padded(raw, 3), r.left.mesh, 2, actual);
      ASSERT_TRUE(same("color", expected, actual)) << size << " " << max_units;
    }
  }
}

TEST_P(Pipelines, TimesOfEveryStage) {
  const cv::Size size(100, 40);
  const SlantedPair pair = textured_pair(size, 13);
  Pipeline pipeline;
  for (Parameters p : {window_parameters(), Parameters()}) {
    p.dense = p.stereo_algorithm == StereoAlgorithm::kSgm;
    std::set<Stage> unused{Stage::kMatch};
    if (!p.dense) unused = {Stage::kCost, Stage::kAggregate, Stage::kFill, Stage::kMedian};
    const DisparityFrame& frame = pipeline.process(pair.left, pair.right, identity_for(size), p, 2);
    for (std::size_t i = 0; i < frame.ms.size(); ++i) {
      EXPECT_EQ(frame.ms[i] > 0, unused.count(static_cast<Stage>(i)) == 0)
          << kStageNames[i] << ": " << frame.ms[i] << " ms";
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<std::string>& info) { return info.param; }
INSTANTIATE_TEST_SUITE_P(Targets, Pipelines, ::testing::ValuesIn(targets()), name_of);

TEST(RectifyImage, EqualsTheNaiveModel) {
  const cv::Mat3b raw = random_color_image({33, 26}, 12);
  const Mesh mesh = random_rectification(raw.size(), 12).left.mesh;
  for (const int threads : {1, 2, 3, 7, 50}) {
    cv::Mat out;
    rectify_image(raw, mesh, threads, out);
    EXPECT_TRUE(test::same("rectify", naive::rectify(raw, mesh), out)) << threads;
  }
}

TEST(ValidateImage, RefusesOtherSizesByName) {
  const StereoRectification r = identity_for({64, 48});
  EXPECT_TRUE(validate_image(cv::Mat1b(48, 64), r, "left"));
  const Status status = validate_image(cv::Mat1b(50, 60), r, "right");
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kImageSize);
  for (const std::string word : {"right", "60x50", "64x48"}) {
    EXPECT_NE(status.error().message.find(word), std::string::npos) << status.error().message;
  }
}

TEST(ValidateImage, RefusesEmptyAndTooLargeImages) {
  EXPECT_TRUE(validate_image(cv::Mat1b(1200, 1920), identity_for({1920, 1200}), "left"));
  EXPECT_TRUE(validate_image(cv::Mat1b(1, 1), identity_for({1, 1}), "left"));
  for (const cv::Size size : {cv::Size(1921, 8), {8, 1201}}) {
    const Status status = validate_image(cv::Mat1b(size), identity_for(size), "left");
    ASSERT_FALSE(status) << size;
    EXPECT_EQ(status.error().kind, ErrorKind::kImageSize);
    EXPECT_NE(status.error().message.find("1920x1200"), std::string::npos);
  }
  EXPECT_FALSE(validate_image(cv::Mat(), StereoRectification(), "left"));
}

}  // namespace
}  // namespace fpga_stereo::test
