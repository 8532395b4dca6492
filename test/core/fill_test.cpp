#include <gtest/gtest.h>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

constexpr std::uint16_t kNone = kNoDisparity;

std::vector<int> filled(const std::vector<int>& row) {
  cv::Mat1w disparity(1, static_cast<int>(row.size()));
  std::copy(row.begin(), row.end(), disparity.begin());
  fill(cv::Range::all(), disparity);
  return {disparity.begin(), disparity.end()};
}

TEST(Fill, TakesTheSmallerOfTheNearestDisparities) {
  using Row = std::vector<int>;
  EXPECT_EQ(filled({320, kNone, kNone, 64, 96}), (Row{320, 64, 64, 64, 96}));
  EXPECT_EQ(filled({64, kNone, 320, 1}), (Row{64, 64, 320, 1}));
  EXPECT_EQ(filled({7, kNone, 7}), (Row{7, 7, 7}));
  EXPECT_EQ(filled({0, kNone, 9}), (Row{0, 0, 9})) << "0 is a disparity";
  // Each gap on its own: what was filled is not a disparity for another gap.
  EXPECT_EQ(filled({5, kNone, 9, kNone, kNone, 8}), (Row{5, 5, 9, 8, 8, 8}));
}

TEST(Fill, KeepsFractions) { EXPECT_EQ(filled({100, kNone, 99}), (std::vector<int>{100, 99, 99})); }

TEST(Fill, TakesTheOnlyNeighbourAtTheEndsOfARow) {
  using Row = std::vector<int>;
  EXPECT_EQ(filled({kNone, kNone, 64}), (Row{64, 64, 64}));
  EXPECT_EQ(filled({64, kNone, kNone}), (Row{64, 64, 64}));
  EXPECT_EQ(filled({kNone, 64, kNone}), (Row{64, 64, 64}));
  EXPECT_EQ(filled({kNone, 900, kNone, 64, kNone}), (Row{900, 900, 64, 64, 64}));
}

TEST(Fill, LeavesAnEmptyRowEmpty) {
  EXPECT_EQ(filled({kNone}), (std::vector<int>{kNone}));
  EXPECT_EQ(filled({kNone, kNone, kNone}), (std::vector<int>{kNone, kNone, kNone}));
  // The rows around it give it nothing.
  cv::Mat1w disparity(3, 4, std::uint16_t{32});
  disparity.row(1) = kNone;
  const cv::Mat1w expected = disparity.clone();
  fill(cv::Range::all(), disparity);
  EXPECT_TRUE(same("fill", expected, disparity));
}

TEST(Fill, LeavesDisparitiesAlone) {
  const cv::Mat1w disparity = cv::Mat_<std::uint16_t>(random_image({31, 20}, 3));
  cv::Mat1w out = disparity.clone();
  fill(cv::Range::all(), out);
  EXPECT_TRUE(same("fill", disparity, out));
}

/// Returns random disparities with this share of holes.
cv::Mat1w with_holes(cv::Size size, double holes, unsigned seed) {
  cv::Mat1w disparity(size);
  cv::RNG rng(seed);
  for (std::uint16_t& value : disparity) {
    value =
        rng.uniform(0.0, 1.0) < holes ? kNone : static_cast<std::uint16_t>(rng.uniform(0, 8161));
  }
  return disparity;
}

TEST(Fill, EqualsTheNaiveModel) {
  unsigned seed = 1300;
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {2, 7}, {64, 33}}) {
    for (const double holes : {0.1, 0.5, 0.95}) {
      const cv::Mat1w in = with_holes(size, holes, ++seed);
      const cv::Mat1w expected = naive::fill(in);
      cv::Mat1w out = in.clone(), part = padded(in, seed);
      fill(cv::Range::all(), out);
      fill(cv::Range::all(), part);
      ASSERT_TRUE(same("fill", expected, out, {{}, seed, "random"}));
      ASSERT_TRUE(same("fill", expected, part, {{}, seed, "padded"}));
    }
  }
}

TEST(Fill, WritesTheGivenRowsOnly) {
  const cv::Mat1w in = with_holes({20, 9}, 0.6, 7);
  cv::Mat1w expected = in.clone(), out = in.clone();
  naive::fill(in).rowRange(2, 6).copyTo(expected.rowRange(2, 6));
  fill({2, 6}, out);
  EXPECT_TRUE(same("fill", expected, out));
}

}  // namespace
}  // namespace fpga_stereo::test
