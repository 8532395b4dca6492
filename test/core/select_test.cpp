#include <gtest/gtest.h>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

using Around = cv::Vec<std::uint16_t, 5>;

/// Returns sums of a row of `width` pixels that do not depend on x.
cv::Mat1w equal_columns(const std::vector<std::uint16_t>& sums, int width) {
  cv::Mat1w column(static_cast<int>(sums.size()), 1);
  std::copy(sums.begin(), sums.end(), column.begin());
  return cv::repeat(column, 1, width);
}

Selection select_row(const cv::Mat1w& sums) {
  Selection out;
  create(out, {sums.cols, 1});
  select(sums, 0, out);
  return out;
}

TEST(Select, ByHand) {
  const Selection s = select_row(equal_columns({90, 80, 30, 20, 40, 70, 60, 95}, 12));
  EXPECT_EQ(s.winner(0, 5), 3);
  EXPECT_EQ(s.winner_sum(0, 5), 20);
  EXPECT_EQ(s.runner_up_sum(0, 5), 60) << "30 and 40 are the winner's neighbours";
  EXPECT_EQ(s.around(0, 5), Around(80, 30, 20, 40, 70));
  EXPECT_EQ(s.right_winner(0, 5), 3);
  // Only d < W - xr are searched, so the last right pixels have fewer disparities.
  EXPECT_EQ(s.right_winner(0, 8), 3);
  EXPECT_EQ(s.right_winner(0, 9), 2);
  EXPECT_EQ(s.right_winner(0, 10), 1);
  EXPECT_EQ(s.right_winner(0, 11), 0);
}

TEST(Select, TakesTheLowestDisparityOfEqualSums) {
  const Selection s = select_row(equal_columns({9, 5, 7, 7, 5, 7, 7, 5}, 12));
  EXPECT_EQ(s.winner(0, 0), 1);
  EXPECT_EQ(s.right_winner(0, 0), 1);
  EXPECT_EQ(s.winner_sum(0, 0), 5);
  EXPECT_EQ(s.runner_up_sum(0, 0), 5) << "an equal sum further away is a runner-up";
}

TEST(Select, FlatSums) {
  for (const std::uint16_t value : {0, 52920, 65535}) {
    const Selection s = select_row(equal_columns(std::vector<std::uint16_t>(8, value), 3));
    EXPECT_EQ(cv::countNonZero(s.winner), 0);
    EXPECT_EQ(cv::countNonZero(s.right_winner), 0);
    EXPECT_EQ(s.winner_sum(0, 1), value);
    EXPECT_EQ(s.runner_up_sum(0, 1), value);
    EXPECT_EQ(s.around(0, 1), Around(0, 0, value, value, value));
  }
}

TEST(Select, AroundIsZeroBeyondTheRange) {
  const auto around = [](int winner) {
    std::vector<std::uint16_t> sums{11, 12, 13, 14, 15, 16, 17, 18};
    sums[static_cast<std::size_t>(winner)] = 1;
    return select_row(equal_columns(sums, 2)).around(0, 0);
  };
  EXPECT_EQ(around(0), Around(0, 0, 1, 12, 13));
  EXPECT_EQ(around(1), Around(0, 11, 1, 13, 14));
  EXPECT_EQ(around(2), Around(11, 12, 1, 14, 15));
  EXPECT_EQ(around(5), Around(14, 15, 1, 17, 18));
  EXPECT_EQ(around(6), Around(15, 16, 1, 18, 0));
  EXPECT_EQ(around(7), Around(16, 17, 1, 0, 0));
}

TEST(Select, RunnerUpExcludesDirectNeighboursOnly) {
  std::vector<std::uint16_t> sums{50, 50, 3, 2, 1, 2, 4, 50};
  EXPECT_EQ(select_row(equal_columns(sums, 1)).runner_up_sum(0, 0), 3);
  sums[2] = 50;
  EXPECT_EQ(select_row(equal_columns(sums, 1)).runner_up_sum(0, 0), 4);
}

TEST(Select, RightWinnerFollowsTheDiagonal) {
  cv::Mat1w sums(8, 16, std::uint16_t{100});
  sums(5, 9) = 7;  // left pixel 9 at disparity 5 is right pixel 4
  const Selection s = select_row(sums);
  EXPECT_EQ(s.right_winner(0, 4), 5);
  EXPECT_EQ(s.right_winner(0, 9), 0);
  EXPECT_EQ(s.winner(0, 9), 5);
  EXPECT_EQ(s.winner(0, 4), 0);
}

TEST(Select, Disparity255) {
  std::vector<std::uint16_t> sums(256, 9);
  sums[255] = 1;
  const Selection s = select_row(equal_columns(sums, 300));
  EXPECT_EQ(s.winner(0, 299), 255);
  EXPECT_EQ(s.right_winner(0, 44), 255);
  EXPECT_EQ(s.right_winner(0, 45), 0);
}

TEST(Select, EqualsTheNaiveModel) {
  unsigned seed = 800;
  for (const int width : {1, 2, 7, 30, 65}) {
    for (const int range : {8, 12, 16, 64, 128, 256}) {
      for (const int end : {2, 40, 65536}) {  // few values give many ties
        cv::RNG rng(++seed);
        naive::Sums all;
        Selection actual;
        create(actual, {width, 3});
        for (int y = 0; y < 3; ++y) {
          cv::Mat1w sums(range, width);
          rng.fill(sums, cv::RNG::UNIFORM, 0, end);
          all.emplace_back();
          sums.convertTo(all.back(), CV_32S);
          select(padded(sums, seed), y, actual);
        }
        Parameters p = window_parameters();
        p.disparity_range = range;
        ASSERT_TRUE(same("select", naive::select(all), actual, {p, seed, "random sums"}))
            << "sums below " << end;
      }
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
