#include <gtest/gtest.h>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

/// Returns a row in which left and right pixels have disparity 5 and no runner-up comes close.
Selection agreeing_row() {
  Selection s;
  create(s, {20, 1});
  s.winner = 5;
  s.right_winner = 5;
  s.winner_sum = 10;
  s.runner_up_sum = 1000;
  return s;
}

Selection random_selection(cv::Size size, int range, unsigned seed) {
  Selection s;
  create(s, size);
  cv::RNG rng(seed);
  rng.fill(s.winner, cv::RNG::UNIFORM, 0, range);
  rng.fill(s.right_winner, cv::RNG::UNIFORM, 0, range);
  rng.fill(s.winner_sum, cv::RNG::UNIFORM, 0, 52921);
  rng.fill(s.runner_up_sum, cv::RNG::UNIFORM, 0, 52921);
  return s;
}

cv::Mat1b check_of(const Selection& s, const Parameters& p) {
  cv::Mat1b kept;
  check(s, p, cv::Range::all(), kept);
  return kept;
}

bool is_unique(double ratio, int winner_sum, int runner_up_sum) {
  Selection s = agreeing_row();
  s.winner_sum = winner_sum;
  s.runner_up_sum = runner_up_sum;
  Parameters p = window_parameters();
  p.uniqueness_ratio = ratio;
  return check_of(s, p)(0, 10) == 1;
}

TEST(Check, KeepsPixelsThatAgree) {
  const cv::Mat1b kept = check_of(agreeing_row(), window_parameters());
  // The partners of the first five pixels lie left of the right image.
  EXPECT_EQ(cv::countNonZero(kept.colRange(0, 5)), 0);
  EXPECT_EQ(cv::countNonZero(kept.colRange(5, 20) == 1), 15);
}

TEST(Check, MaximumDifference) {
  for (const int max_difference : {0, 1, 2, 128}) {
    for (int difference = -4; difference <= 4; ++difference) {
      Selection s = agreeing_row();
      s.right_winner(0, 10 - 5) = static_cast<std::uint8_t>(5 + difference);
      Parameters p = window_parameters();
      p.disp12MaxDiff = max_difference;
      EXPECT_EQ(check_of(s, p)(0, 10), std::abs(difference) <= max_difference ? 1 : 0)
          << max_difference << " " << difference;
    }
  }
}

// N = 256 (1 + 33 / 100) = 340.48, rounded to 340, so v2 must be greater than 340 / 256 v1.
TEST(Check, UniquenessAtItsThreshold) {
  EXPECT_FALSE(is_unique(33, 256, 339));
  EXPECT_FALSE(is_unique(33, 256, 340));
  EXPECT_TRUE(is_unique(33, 256, 341));
  // For any v1: the largest v2 that fails and the smallest that passes.
  for (const int v1 : {1, 64, 1000, 5400, 27000, 49000}) {
    const int limit = 340 * v1 / 256;
    EXPECT_FALSE(is_unique(33, v1, limit)) << v1;
    EXPECT_TRUE(is_unique(33, v1, limit + 1)) << v1;
  }
  EXPECT_FALSE(is_unique(33, 0, 0));
  EXPECT_TRUE(is_unique(33, 0, 1));
}

TEST(Check, UniquenessRatioAtItsLimits) {
  EXPECT_FALSE(is_unique(0, 1000, 1000));
  EXPECT_TRUE(is_unique(0, 1000, 1001));
  EXPECT_FALSE(is_unique(100, 26460, 52920));
  EXPECT_TRUE(is_unique(100, 26459, 52920));
  EXPECT_FALSE(is_unique(100, 52920, 52920)) << "no overflow";
}

TEST(Check, RatioIsRoundedToTheNearest256th) {
  EXPECT_TRUE(is_unique(0.19, 256, 257)) << "N = 256.4864 is rounded to 256";
  EXPECT_FALSE(is_unique(0.2, 256, 257)) << "N = 256.512 is rounded to 257";
  EXPECT_FALSE(is_unique(0.1953125, 256, 257)) << "N = 256.5 is rounded to 257";
  EXPECT_TRUE(is_unique(0.1953125, 256, 258));
}

TEST(Check, EachCheckCanBeSwitchedOff) {
  Selection s = agreeing_row();
  s.right_winner(0, 5) = 100;   // pixel 10 disagrees
  s.runner_up_sum(0, 12) = 10;  // pixel 12 is not unique
  for (const bool left_right : {false, true}) {
    for (const bool uniqueness : {false, true}) {
      Parameters p = window_parameters();
      p.left_right_check = left_right;
      p.uniqueness_check = uniqueness;
      const cv::Mat1b kept = check_of(s, p);
      EXPECT_EQ(kept(0, 2), left_right ? 0 : 1);
      EXPECT_EQ(kept(0, 10), left_right ? 0 : 1);
      EXPECT_EQ(kept(0, 12), uniqueness ? 0 : 1);
      EXPECT_EQ(kept(0, 14), 1);
    }
  }
}

// A pixel that is filled from its neighbours is worse than one that is not unique.
TEST(Check, DenseSwitchesTheUniquenessCheckOff) {
  Selection s = agreeing_row();
  s.right_winner(0, 5) = 100;   // pixel 10 disagrees
  s.runner_up_sum(0, 12) = 10;  // pixel 12 is not unique
  for (Parameters p : {window_parameters(), Parameters()}) {
    p.dense = true;
    const cv::Mat1b kept = check_of(s, p);
    EXPECT_EQ(kept(0, 10), 0) << "the left-right check stays on";
    EXPECT_EQ(kept(0, 12), 1);
    EXPECT_EQ(kept(0, 14), 1);
  }
}

TEST(Check, EqualsTheNaiveModel) {
  unsigned seed = 900;
  for (const cv::Size size : {cv::Size(1, 1), {1, 8}, {9, 1}, {41, 13}}) {
    for (const double ratio : {0.0, 5.5, 33.0, 99.9}) {
      for (const int difference : {0, 1, 7}) {
        for (int switches = 0; switches < 8; ++switches) {
          Parameters p = window_parameters();
          p.uniqueness_ratio = ratio;
          p.disp12MaxDiff = difference;
          p.left_right_check = (switches & 1) != 0;
          p.uniqueness_check = (switches & 2) != 0;
          p.dense = (switches & 4) != 0;
          Selection s = random_selection(size, 16, ++seed);
          const cv::Mat1b expected = naive::check(s, p);
          ASSERT_TRUE(same("check", expected, check_of(s, p), {p, seed, "random"}));
          s.winner = padded(s.winner, 1);
          s.right_winner = padded(s.right_winner, 2);
          s.winner_sum = padded(s.winner_sum, 3);
          s.runner_up_sum = padded(s.runner_up_sum, 4);
          ASSERT_TRUE(same("check", expected, check_of(s, p), {p, seed, "padded"}));
        }
      }
    }
  }
}

TEST(Check, WritesTheGivenRowsOnly) {
  const Selection s = random_selection({15, 9}, 8, 42);
  const Parameters p = window_parameters();
  cv::Mat1b kept(9, 15, std::uint8_t{77});
  cv::Mat1b expected = kept.clone();
  naive::check(s, p).rowRange(2, 6).copyTo(expected.rowRange(2, 6));
  check(s, p, {2, 6}, kept);
  EXPECT_TRUE(same("check", expected, kept, {p, 42, "rows 2 .. 5"}));
}

}  // namespace
}  // namespace fpga_stereo::test
