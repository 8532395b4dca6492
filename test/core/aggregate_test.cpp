#include <gtest/gtest.h>

#include <algorithm>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

using Row = std::vector<int>;

Parameters aggregate_parameters(SgmBuild build, int p1, int p2) {
  Parameters p;
  p.disparity_range = 8;
  p.sgm_build = build;
  p.sgm_p1 = p1;
  p.sgm_p2 = p.sgm_p2_edge = p.sgm_p2_strong_edge = p2;
  return p;
}

/// Returns S of a whole image; [y] is D x W.
std::vector<cv::Mat1w> sums_of(const cv::Mat1b& left, const std::vector<cv::Mat1b>& costs,
                               const Parameters& p) {
  Aggregate aggregate;
  aggregate.start(left, p);
  std::vector<cv::Mat1w> sums;
  for (const cv::Mat1b& row : costs) sums.push_back(aggregate.next(row).clone());
  return sums;
}

cv::Mat1b flat(cv::Size size) { return cv::Mat1b(size, std::uint8_t{90}); }

/// Returns the costs of a row from those of its pixels.
cv::Mat1b costs_of_pixels(const std::vector<Row>& pixels) {
  cv::Mat1b costs(static_cast<int>(pixels[0].size()), static_cast<int>(pixels.size()));
  for (int x = 0; x < costs.cols; ++x) {
    for (int d = 0; d < costs.rows; ++d) {
      costs(d, x) = static_cast<std::uint8_t>(pixels[x][d]);
    }
  }
  return costs;
}

Row column(const cv::Mat& row, int x) {
  const cv::Mat1i values = cv::Mat_<int>(row.col(x));
  return {values.begin(), values.end()};
}

Row minus(Row a, const Row& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] -= b[i];
  return a;
}

const Row kNoCost(8, 0);

const std::vector<Row> kPixels{{0, 3, 3, 3, 3, 3, 3, 3}, kNoCost, {3, 0, 3, 3, 3, 3, 3, 3},
                               {3, 3, 0, 3, 3, 3, 3, 3}, kNoCost, kNoCost};
// L - M of these costs with P1 = 1 and P2 = 6. M = 0 0 1 2 2 2.
const std::vector<Row> kPath{
    {0, 3, 3, 3, 3, 3, 3, 3}, {0, 1, 3, 3, 3, 3, 3, 3},  // d = 1: 0 + P1
    {3, 1, 5, 6, 6, 6, 6, 6}, {4, 3, 1, 8, 8, 8, 8, 8},  // d >= 3: M(0) + P2 = 6; less M(2) = 1
    {3, 1, 0, 1, 4, 4, 4, 4},                            // d >= 4: M(1) + P2 = 6; less M(3) = 2
    {2, 1, 0, 1, 2, 4, 4, 4},                            // d >= 5: still 6, since M(2) + P2 = 7
};

TEST(Aggregate, PathFromTheLeftByHand) {
  const Parameters p = aggregate_parameters(SgmBuild::kSmall, 1, 6);
  const auto sums = sums_of(flat({6, 1}), {costs_of_pixels(kPixels)}, p);
  for (int x = 0; x < 6; ++x) {
    // In the first row, the path from above is the cost.
    EXPECT_EQ(minus(column(sums[0], x), kPixels[x]), kPath[x]) << "pixel " << x;
  }
}

/// Reverses the order of the disparities.
std::vector<Row> from_the_far_end(std::vector<Row> pixels) {
  for (Row& pixel : pixels) std::reverse(pixel.begin(), pixel.end());
  return pixels;
}

TEST(Aggregate, BothEndsOfTheSearchRangeAreAlike) {
  const Parameters p = aggregate_parameters(SgmBuild::kSmall, 1, 6);
  const std::vector<Row> pixels = from_the_far_end(kPixels), path = from_the_far_end(kPath);
  const auto sums = sums_of(flat({6, 1}), {costs_of_pixels(pixels)}, p);
  for (int x = 0; x < 6; ++x) {
    EXPECT_EQ(minus(column(sums[0], x), pixels[x]), path[x]) << "pixel " << x;
  }
}

TEST(Aggregate, PathFromTheRightIsTheMirrorImage) {
  std::vector<Row> pixels = kPixels;
  std::reverse(pixels.begin(), pixels.end());
  const std::vector<cv::Mat1b> costs{costs_of_pixels(pixels)};
  const auto all = sums_of(flat({6, 1}), costs, aggregate_parameters(SgmBuild::kFull, 1, 6));
  const auto others = sums_of(flat({6, 1}), costs, aggregate_parameters(SgmBuild::kSmall, 1, 6));
  for (int x = 0; x < 6; ++x) {
    EXPECT_EQ(minus(column(all[0], x), column(others[0], x)), kPath[5 - x]) << "pixel " << x;
  }
}

// A row of one pixel has S = L(from the left) + L(from the right) + L(from above) = 2 C + L.
TEST(Aggregate, PathFromAboveByHand) {
  const Row far{3, 3, 3, 0, 3, 3, 3, 3};
  const std::vector<Row> pixels{
      {0, 3, 3, 3, 3, 3, 3, 3}, {3, 0, 3, 3, 3, 3, 3, 3}, kNoCost, far, far, kNoCost};
  const std::vector<Row> paths{
      {0, 3, 3, 3, 3, 3, 3, 3},                            // the first row
      {3, 1, 6, 6, 6, 6, 6, 6},                            // smallest 1, so N = 2 0 5 5 5 5 5 5
      {1, 0, 1, 5, 5, 5, 5, 5}, {4, 3, 4, 2, 8, 8, 8, 8},  // smallest 2
      {5, 4, 4, 0, 4, 9, 9, 9},                            // d >= 5: P2 + 3
      {5, 4, 1, 0, 1, 5, 6, 6},                            // d >= 6: P2
  };
  std::vector<cv::Mat1b> costs;
  for (const Row& pixel : pixels) costs.push_back(costs_of_pixels({pixel}));
  const auto sums = sums_of(flat({1, 6}), costs, aggregate_parameters(SgmBuild::kFull, 1, 6));
  for (int y = 0; y < 6; ++y) {
    const Row twice = minus(minus(column(sums[y], 0), pixels[y]), pixels[y]);
    EXPECT_EQ(twice, paths[y]) << "row " << y;
  }
}

// small: t = (step from above + step from above right) >> 1. Both pixels of a row cost the same.
TEST(Aggregate, SmallBuildAveragesTwoPathsFromAbove) {
  const Row pixel{0, 3, 3, 3, 3, 3, 3, 3};
  const std::vector<cv::Mat1b> costs{costs_of_pixels({pixel, pixel}),
                                     costs_of_pixels({kNoCost, kNoCost})};
  const Parameters p = aggregate_parameters(SgmBuild::kSmall, 1, 6);
  const auto sums = sums_of(flat({2, 2}), costs, p);
  // Row 1: both steps are 0 1 3 3 ... The path from the left adds nothing at x = 0.
  EXPECT_EQ(column(sums[1], 0), (Row{0, 1, 3, 3, 3, 3, 3, 3}));
  // At the end of the row, the step from outside the image is 0.
  EXPECT_EQ(column(sums[1], 1), (Row{0, 0, 1, 1, 1, 1, 1, 1}));
}

TEST(Aggregate, SmallBuildRoundsTheAverageDown) {
  const std::vector<cv::Mat1b> costs{
      costs_of_pixels({{0, 3, 2, 0, 3, 3, 3, 1}, {3, 0, 3, 3, 3, 3, 3, 3}, kNoCost}),
      costs_of_pixels({kNoCost, kNoCost, kNoCost})};
  const Parameters p = aggregate_parameters(SgmBuild::kSmall, 15, 15);
  const auto sums = sums_of(flat({3, 2}), costs, p);
  EXPECT_EQ(column(sums[1], 0), (Row{1, 1, 2, 1, 3, 3, 3, 2}));
  EXPECT_EQ(column(sums[1], 1), (Row{1, 0, 1, 1, 1, 1, 1, 1})) << "right neighbour: no cost";
}

/// Costs of pixels whose disparity 0 is right: 3 for the others. In the last one all are equal, so
/// that S of a far disparity shows the penalty.
std::vector<Row> pixels_at_zero(int before) {
  std::vector<Row> pixels(before, Row{0, 3, 3, 3, 3, 3, 3, 3});
  pixels.push_back(kNoCost);
  return pixels;
}

/// Returns the penalty on a ramp, whose neighbours differ by `step` once they are smoothed.
int penalty_on_ramp(int step, const Parameters& p) {
  std::vector<Row> pixels = pixels_at_zero(6);
  pixels.resize(10, kNoCost);  // the ramp must not end near pixel 6
  const cv::Mat1b image = ramp({10, 1}, step, 0);
  return sums_of(image, {costs_of_pixels(pixels)}, p)[0](7, 6);
}

TEST(Aggregate, PenaltyDependsOnTheEdge) {
  Parameters p = aggregate_parameters(SgmBuild::kSmall, 15, 15);
  p.sgm_p2_edge = 11;
  p.sgm_p2_strong_edge = 7;
  p.sgm_edge = 6;
  p.sgm_strong_edge = 14;
  EXPECT_EQ(penalty_on_ramp(0, p), 15);
  EXPECT_EQ(penalty_on_ramp(5, p), 15);
  EXPECT_EQ(penalty_on_ramp(6, p), 11);
  EXPECT_EQ(penalty_on_ramp(13, p), 11);
  EXPECT_EQ(penalty_on_ramp(14, p), 7);
  EXPECT_EQ(penalty_on_ramp(25, p), 7);
  p.sgm_edge = 0;
  EXPECT_EQ(penalty_on_ramp(0, p), 11) << "no difference is below 0";
  p.sgm_strong_edge = 0;
  EXPECT_EQ(penalty_on_ramp(0, p), 7);
  p.sgm_edge = 20;
  p.sgm_strong_edge = 10;
  EXPECT_EQ(penalty_on_ramp(15, p), 15) << "sgm_edge decides first";
}

/// Returns an image of two shades whose border is at column 4 | 5. Smoothed differences across it
/// are 2, 8, 12, 8, 2, of which one is an edge.
cv::Mat1b two_shades(int width, int height) {
  cv::Mat1b image(height, width, std::uint8_t{100});
  image.colRange(5, width) = 132;
  return image;
}

Parameters one_edge(SgmBuild build) {
  Parameters p = aggregate_parameters(build, 15, 15);
  p.sgm_p2_edge = 6;
  p.sgm_edge = 9;
  p.sgm_strong_edge = 255;
  return p;
}

TEST(Aggregate, PenaltyBelongsToBothPixelsOfAStep) {
  const cv::Mat1b image = two_shades(12, 1);
  Parameters p = one_edge(SgmBuild::kSmall);
  const auto small = [&](int x) {  // path from the left to pixel x, where nothing costs
    std::vector<Row> pixels = pixels_at_zero(x);
    pixels.resize(12, kNoCost);
    return sums_of(image, {costs_of_pixels(pixels)}, p)[0](7, x);
  };
  EXPECT_EQ(small(4), 12) << "3 per pixel, P2 = 15";
  EXPECT_EQ(small(5), 6) << "P2 at the edge";
  EXPECT_EQ(small(6), 9) << "3 more than the step over the edge";
  p.sgm_edge = 13;
  EXPECT_EQ(small(5), 15) << "12 is no edge; without smoothing the difference would be 32";
  const auto right = [&](int x) {  // path from the right
    std::vector<Row> pixels(x + 1, kNoCost);
    pixels.resize(12, Row{0, 3, 3, 3, 3, 3, 3, 3});
    const std::vector<cv::Mat1b> costs{costs_of_pixels(pixels)};
    return sums_of(image, costs, one_edge(SgmBuild::kFull))[0](7, x) -
           sums_of(image, costs, one_edge(SgmBuild::kSmall))[0](7, x);
  };
  EXPECT_EQ(right(5), 15);
  EXPECT_EQ(right(4), 6) << "P2 at the edge";
  EXPECT_EQ(right(3), 9);
}

TEST(Aggregate, PenaltyOfThePathsFromAbove) {
  const int height = 5;
  std::vector<cv::Mat1b> costs(height - 1,
                               costs_of_pixels(std::vector<Row>(16, Row{0, 3, 3, 3, 3, 3, 3, 3})));
  costs.push_back(costs_of_pixels(std::vector<Row>(16, kNoCost)));
  // The last row costs nothing, so only the path from above contributes there.
  const auto sums = sums_of(two_shades(16, height), costs, one_edge(SgmBuild::kSmall));
  EXPECT_EQ(sums[4](7, 2), 12) << "3 per row, P2 = 15";
  EXPECT_EQ(sums[4](7, 5), 12);
  // Pixel (4, y) has the edge between it and (5, y - 1), so that step is limited to 6:
  // L = 3, (3 + 3) / 2 + 3 = 6, (6 + 6) / 2 + 3 = 9, (9 + 6) / 2 + 3 = 10, (10 + 6) / 2 = 8.
  EXPECT_EQ(sums[4](7, 4), 8);
  EXPECT_EQ(sums[4](7, 3), 11) << "12 straight above, 10 above right";
  // The same edge between rows.
  std::vector<cv::Mat1b> rows(6, costs_of_pixels({Row{0, 3, 3, 3, 3, 3, 3, 3}}));
  rows[5] = rows[4].clone();
  rows[5].setTo(0);
  const auto across = sums_of(two_shades(10, 1).t(), rows, one_edge(SgmBuild::kFull));
  EXPECT_EQ(across[4](7, 0), 3 + 3 + 15);
  EXPECT_EQ(across[5](7, 0), 6) << "P2 at the edge";
}

/// Returns costs 0 .. 3, of which the smallest of each pixel is 0.
cv::Mat1b random_costs(int range, int width, unsigned seed) {
  cv::Mat1b costs(range, width);
  cv::RNG rng(seed);
  rng.fill(costs, cv::RNG::UNIFORM, 0, 4);
  // Few pixels are undecided, so that path costs grow.
  for (std::uint8_t& c : costs) c = c == 0 && rng.uniform(0, 3) != 0 ? 3 : c;
  for (int x = 0; x < width; ++x) costs(rng.uniform(0, range), x) = 0;
  return costs;
}

// What lets hardware compute S without a sign, in six bits. It holds for every P1 and P2.
TEST(Aggregate, MinimaNeverDecreaseAndSumsHaveSixBits) {
  const int width = 40, height = 12;
  unsigned seed = 700;
  int largest = 0;
  for (int p1 = 0; p1 <= 15; ++p1) {
    for (int p2 = 6; p2 <= 15; ++p2) {
      Parameters p = aggregate_parameters(SgmBuild::kFull, p1, p2);
      p.disparity_range = 16;
      naive::Sums costs;
      for (int y = 0; y < height; ++y) {
        costs.emplace_back();
        random_costs(16, width, ++seed).convertTo(costs.back(), CV_32S);
        const naive::Path path = naive::path_from_left(costs.back(), Row(width, p2), p1);
        for (int n = 1; n < width; ++n) {
          const int step = path.minima[n] - path.minima[n - 1];
          ASSERT_TRUE(step >= 0 && step <= 3) << step << ", seed " << seed << ", n " << n;
        }
      }
      for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
        p.sgm_build = build;
        for (const cv::Mat1i& row : naive::aggregate(flat({width, height}), costs, p)) {
          double min = 0, max = 0;
          cv::minMaxLoc(row, &min, &max);
          ASSERT_GE(min, 0) << "P1 " << p1 << ", P2 " << p2;
          ASSERT_LE(max, 54) << "P1 " << p1 << ", P2 " << p2;
          largest = std::max(largest, static_cast<int>(max));
        }
      }
    }
  }
  EXPECT_GT(largest, 45) << "the costs are too small for the test";
}

TEST(Aggregate, LargestSum) {
  const int width = 15, height = 8;
  std::vector<cv::Mat1b> costs(
      height, costs_of_pixels(std::vector<Row>(width, Row{0, 3, 3, 3, 3, 3, 3, 3})));
  const auto sums =
      sums_of(flat({width, height}), costs, aggregate_parameters(SgmBuild::kFull, 15, 15));
  EXPECT_EQ(sums[height - 1](7, width / 2), 54) << "15 + 3 in each of three paths";
  EXPECT_EQ(sums[height - 1](0, width / 2), 0);
}

::testing::AssertionResult equals_naive(const cv::Mat1b& left, const std::vector<cv::Mat1b>& costs,
                                        const Case& c) {
  naive::Sums wide;
  for (const cv::Mat1b& row : costs) {
    wide.emplace_back();
    row.convertTo(wide.back(), CV_32S);
  }
  const naive::Sums expected = naive::aggregate(left, wide, c.parameters);
  const auto actual = sums_of(left, costs, c.parameters);
  auto result = ::testing::AssertionSuccess();
  for (std::size_t y = 0; y < costs.size() && result; ++y) {
    const cv::Mat1w row = cv::Mat_<std::uint16_t>(expected[y]);
    result = same("aggregate, row " + std::to_string(y), row, actual[y], c);
  }
  return result;
}

TEST(Aggregate, EqualsTheNaiveModel) {
  unsigned seed = 500;
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {2, 3}, {9, 1}, {5, 4}, {31, 17}, {64, 8}}) {
    for (const int range : {8, 12, 64, 256}) {
      for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
        for (const auto& [p1, p2, edge, strong] :
             {std::array<int, 4>{5, 15, 10, 7}, {0, 6, 6, 6}, {15, 15, 15, 15}, {1, 6, 9, 14}}) {
          Parameters p = aggregate_parameters(build, p1, p2);
          p.disparity_range = range;
          p.sgm_p2_edge = edge;
          p.sgm_p2_strong_edge = strong;
          std::vector<cv::Mat1b> costs;
          for (int y = 0; y < size.height; ++y) {
            ++seed;
            costs.emplace_back(padded(random_costs(range, size.width, seed), seed));
          }
          const cv::Mat1b left = random_image(size, seed);
          ASSERT_TRUE(equals_naive(left, costs, {p, seed, "noise"}));
          ASSERT_TRUE(equals_naive(padded(left / 8, 1), costs, {p, seed, "dark noise, padded"}));
        }
      }
    }
  }
}

TEST(Aggregate, ForgetsEarlierFrames) {
  Aggregate used;
  unsigned seed = 600;
  for (const cv::Size size : {cv::Size(20, 5), {7, 9}, {1, 1}, {33, 4}}) {
    for (const SgmBuild build : {SgmBuild::kFull, SgmBuild::kSmall}) {
      Parameters p;  // with a P2 that depends on the image
      p.sgm_build = build;
      p.disparity_range = build == SgmBuild::kFull ? 24 : 8;
      const cv::Mat1b left = random_image(size, ++seed);
      std::vector<cv::Mat1b> costs;
      for (int y = 0; y < size.height; ++y) {
        costs.push_back(random_costs(p.disparity_range, size.width, ++seed));
      }
      const auto expected = sums_of(left, costs, p);
      used.start(left, p);
      for (int y = 0; y < size.height; ++y) {
        ASSERT_TRUE(same("aggregate", expected[y], used.next(costs[y]), {p, seed, "used"})) << y;
      }
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
