#include <gtest/gtest.h>

#include <algorithm>

#include "core/sgm_images.hpp"
#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

using Row = std::vector<int>;

Parameters cost_parameters(int range, int shift) {
  Parameters p;
  p.disparity_range = range;
  p.cost_shift = shift;
  return p;
}

/// Returns C of a whole image; [y] is D x W.
std::vector<cv::Mat1b> costs_of(const cv::Mat1b& left, const cv::Mat1b& right,
                                const cv::Mat& left_bits, const cv::Mat& right_bits,
                                const Parameters& p) {
  Cost cost;
  cost.start(left, right, left_bits, right_bits, p, 0);
  std::vector<cv::Mat1b> rows;
  for (int y = 0; y < left.rows; ++y) rows.push_back(cost.next().clone());
  return rows;
}

/// Returns C(x, y, d) for every d.
Row column(const std::vector<cv::Mat1b>& costs, int x, int y) {
  Row column;
  for (int d = 0; d < costs[y].rows; ++d) column.push_back(costs[y](d, x));
  return column;
}

/// Grey images and census bits that are the same everywhere.
struct FlatPair {
  explicit FlatPair(cv::Size size)
      : left(size, std::uint8_t{100}),
        right(left.clone()),
        left_bits(size, 0),
        right_bits(size, 0) {}
  std::vector<cv::Mat1b> costs(const Parameters& p) const {
    return costs_of(left, right, left_bits, right_bits, p);
  }
  cv::Mat1b left, right;
  cv::Mat1i left_bits, right_bits;
};

/// Right pixel x has x census bits, so p(x, d) = x - d for a left pixel without bits.
FlatPair rising_bits() {
  FlatPair pair({12, 1});
  for (int x = 0; x < 12; ++x) pair.right_bits(0, x) = (1 << x) - 1;
  return pair;
}

TEST(Cost, HammingDistancesByHand) {
  const FlatPair pair = rising_bits();
  // p = 9 8 7 6 5 4 3 2, so s - min = 7 6 5 4 3 2 1 0.
  EXPECT_EQ(column(pair.costs(cost_parameters(8, 0)), 9, 0), (Row{3, 3, 3, 3, 3, 2, 1, 0}));
  EXPECT_EQ(column(pair.costs(cost_parameters(8, 1)), 9, 0), (Row{3, 3, 2, 2, 1, 1, 0, 0}));
  EXPECT_EQ(column(pair.costs(cost_parameters(8, 2)), 9, 0), (Row{1, 1, 1, 1, 0, 0, 0, 0}));
  EXPECT_EQ(column(pair.costs(cost_parameters(8, 3)), 9, 0), Row(8, 0));
}

TEST(Cost, AllBitsOfTheCensusCount) {
  FlatPair pair({12, 1});
  pair.right_bits(0, 7) = 0xFFFF;
  Parameters p = cost_parameters(8, 2);
  // Only d = 2 differs: by 16 bits, which is 4 after the shift, so C is limited to 3.
  EXPECT_EQ(column(pair.costs(p), 9, 0), (Row{0, 0, 3, 0, 0, 0, 0, 0}));
  p.cost_shift = 3;
  EXPECT_EQ(column(pair.costs(p), 9, 0), (Row{0, 0, 2, 0, 0, 0, 0, 0}));
  pair.left_bits(0, 9) = 0x8000;
  EXPECT_EQ(column(pair.costs(p), 9, 0), (Row{0, 0, 1, 0, 0, 0, 0, 0})) << "15 - 1 = 14";
  p.cost_shift = 4;
  pair.left_bits(0, 9) = 0;
  EXPECT_EQ(column(pair.costs(p), 9, 0), (Row{0, 0, 1, 0, 0, 0, 0, 0}));
}

TEST(Cost, OutsideTheRightImage) {
  const FlatPair pair = rising_bits();
  Parameters p = cost_parameters(8, 0);
  p.cost_outside = 31;
  EXPECT_EQ(column(pair.costs(p), 2, 0), (Row{2, 1, 0, 3, 3, 3, 3, 3}));
  p.cost_outside = 1;
  EXPECT_EQ(column(pair.costs(p), 2, 0), (Row{2, 1, 0, 1, 1, 1, 1, 1}));
  p.cost_outside = 0;
  EXPECT_EQ(column(pair.costs(p), 2, 0), (Row{2, 1, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(column(pair.costs(p), 0, 0), Row(8, 0));
  // The smallest cost may be that of a pixel outside.
  FlatPair far = rising_bits();
  far.left_bits = 0xFF00;
  p.cost_outside = 6;
  p.cost_shift = 1;
  // p = 10 9 8 (bits 0xFF00 and 3, 1, 0) 6 6 6 6 6
  EXPECT_EQ(column(far.costs(p), 2, 0), (Row{2, 1, 1, 0, 0, 0, 0, 0}));
}

// A row outside the image contributes nothing, not even cost_outside.
TEST(Cost, SumsThreeRowsOfThoseInTheImage) {
  Parameters p = cost_parameters(8, 2);
  p.cost_outside = 4;
  for (const int height : {1, 2, 3, 4}) {
    const auto costs = FlatPair({12, height}).costs(p);
    for (int y = 0; y < height; ++y) {
      const int rows = 1 + (y > 0 ? 1 : 0) + (y < height - 1 ? 1 : 0);
      EXPECT_EQ(column(costs, 3, y), (Row{0, 0, 0, 0, rows, rows, rows, rows}))
          << "row " << y << " of " << height;
    }
  }
}

TEST(Cost, SumsTheRowsAboveAndBelow) {
  FlatPair pair({12, 5});
  pair.right_bits(2, 7) = 0xF;  // meets left pixel 9 at d = 2
  const auto costs = pair.costs(cost_parameters(8, 2));
  const Row flat(8, 0), marked{0, 0, 1, 0, 0, 0, 0, 0};
  for (int y = 0; y < 5; ++y) {
    EXPECT_EQ(column(costs, 9, y), y == 0 || y == 4 ? flat : marked) << y;
  }
}

/// Returns the costs of a left pixel and right pixels 7, 6, 5 and 4, of which 5 is brighter.
Row differences(int brighter, const Parameters& grey) {
  FlatPair pair({12, 1});
  pair.right(0, 5) = static_cast<std::uint8_t>(100 + brighter);
  Parameters p = grey;
  p.disparity_range = 8;
  p.cost_shift = 0;
  const Row all = column(pair.costs(p), 11, 0);  // right pixels 11 .. 4
  return {all.begin() + 4, all.end()};
}

TEST(Cost, GreyValuesAreSmoothedAlongTheRow) {
  Parameters p;
  p.cost_difference_limit = 31;
  p.cost_difference_shift = 0;
  // (1 + 2) >> 2, (2 + 2) >> 2, (4 + 2) >> 2 beside the brighter pixel and twice that in it.
  EXPECT_EQ(differences(1, p), (Row{0, 0, 1, 0}));
  EXPECT_EQ(differences(2, p), (Row{0, 1, 1, 1}));
  EXPECT_EQ(differences(4, p), (Row{0, 1, 2, 1}));
  EXPECT_EQ(differences(6, p), (Row{0, 2, 3, 2}));
  EXPECT_EQ(differences(-4, p), (Row{0, 1, 2, 1}));
}

TEST(Cost, GreyDifferenceIsLimitedThenShifted) {
  Parameters p;
  p.cost_difference_limit = 2;
  p.cost_difference_shift = 0;
  EXPECT_EQ(differences(100, p), (Row{0, 2, 2, 2}));
  p.cost_difference_limit = 0;
  EXPECT_EQ(differences(100, p), Row(4, 0));
  p.cost_difference_limit = 7;
  p.cost_difference_shift = 2;
  EXPECT_EQ(differences(100, p), (Row{0, 1, 1, 1})) << "7 >> 2";
  p.cost_difference_limit = 8;
  EXPECT_EQ(differences(100, p), (Row{0, 2, 2, 2})) << "8 >> 2";
  EXPECT_EQ(differences(12, p), (Row{0, 0, 1, 0})) << "3 >> 2, 6 >> 2";
  p.cost_difference_limit = 31;
  p.cost_difference_shift = 4;
  EXPECT_EQ(differences(155, p), (Row{0, 1, 1, 1})) << "31 >> 4";
}

TEST(Cost, BothTermsAreAdded) {
  FlatPair pair({12, 1});
  pair.left = 104;
  pair.left_bits = 1;
  Parameters p = cost_parameters(8, 0);
  p.cost_difference_shift = 2;
  p.cost_outside = 0;
  EXPECT_EQ(column(pair.costs(p), 2, 0), (Row{2, 2, 2, 0, 0, 0, 0, 0}));
}

TEST(SmoothRows, ByHand) {
  const cv::Mat1b image = (cv::Mat1b(2, 4) << 8, 0, 0, 40, 0, 0, 255, 255);
  const cv::Mat1b expected = (cv::Mat1b(2, 4) << 6, 2, 10, 30, 0, 64, 191, 255);
  cv::Mat1b smooth;
  smooth_rows(image, cv::Range::all(), smooth);
  EXPECT_TRUE(same("smooth", expected, smooth));
  const cv::Mat1b single = (cv::Mat1b(2, 1) << 77, 255);
  smooth_rows(single, cv::Range::all(), smooth);
  EXPECT_TRUE(same("smooth", single, smooth));
}

TEST(SmoothBinomial, ByHand) {
  cv::Mat1b image(9, 9, std::uint8_t{0});
  image(4, 4) = 255;
  const int weights[] = {1, 4, 6, 4, 1};
  cv::Mat1b smooth;
  smooth_binomial(image, cv::Range::all(), smooth);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      const bool is_near = std::max(std::abs(x - 4), std::abs(y - 4)) <= 2;
      const int weight = is_near ? weights[x - 2] * weights[y - 2] : 0;
      EXPECT_EQ(smooth(y, x), (255 * weight + 128) >> 8) << x << ", " << y;
    }
  }
}

// With replicated borders, the corner pixel has (6 + 4 + 1)^2 of 256 parts.
TEST(SmoothBinomial, BordersAreReplicated) {
  cv::Mat1b image(6, 7, std::uint8_t{0});
  image(0, 0) = 200;
  cv::Mat1b smooth;
  smooth_binomial(image, cv::Range::all(), smooth);
  EXPECT_EQ(smooth(0, 0), (200 * 121 + 128) >> 8);
  EXPECT_EQ(smooth(0, 1), (200 * 11 * 5 + 128) >> 8);
  EXPECT_EQ(smooth(2, 1), (200 * 1 * 5 + 128) >> 8);
  EXPECT_EQ(smooth(3, 0), 0);
  EXPECT_EQ(smooth(5, 6), 0);
  image(0, 0) = 0;
  image(5, 6) = 200;
  smooth_binomial(image, cv::Range::all(), smooth);
  EXPECT_EQ(smooth(5, 6), (200 * 121 + 128) >> 8);
  EXPECT_EQ(smooth(4, 6), (200 * 11 * 5 + 128) >> 8);
  EXPECT_EQ(smooth(5, 4), (200 * 11 * 1 + 128) >> 8);
  for (const cv::Size size : {cv::Size(1, 1), {1, 7}, {2, 2}, {8, 1}}) {
    const cv::Mat1b flat(size, std::uint8_t{255});
    smooth_binomial(flat, cv::Range::all(), smooth);
    EXPECT_TRUE(same("smooth", flat, smooth));
  }
}

TEST(SgmImages, WriteTheGivenRowsOnly) {
  const cv::Mat1b image = random_image({19, 12}, 5);
  for (const auto smooth : {smooth_rows, smooth_binomial}) {
    cv::Mat1b all, part(image.size(), std::uint8_t{77});
    smooth(image, cv::Range::all(), all);
    cv::Mat1b expected = part.clone();
    all.rowRange(3, 8).copyTo(expected.rowRange(3, 8));
    smooth(image, {3, 8}, part);
    EXPECT_TRUE(same("smooth", expected, part));
  }
}

std::vector<Parameters> cost_variants() {
  std::vector<Parameters> variants;
  for (const int range : {8, 20, 128}) {
    Parameters p;
    p.disparity_range = range;
    variants.push_back(p);
    p.cost_shift = 0;
    p.cost_difference_limit = p.cost_outside = 31;
    p.cost_difference_shift = 0;
    variants.push_back(p);
    p.cost_shift = 6;
    p.cost_difference_shift = 4;
    p.cost_outside = 0;
    variants.push_back(p);
    p.cost_shift = 4;
    p.cost_difference_shift = 0;
    variants.push_back(p);
  }
  return variants;
}

TEST(Cost, EqualsTheNaiveModel) {
  unsigned seed = 300;
  for (const cv::Size size : {cv::Size(1, 1), {1, 5}, {9, 1}, {5, 4}, {31, 7}}) {
    for (const Parameters& p : cost_variants()) {
      for (const NamedImage& input : extreme_images(size, ++seed)) {
        const cv::Mat1b right = random_image(size, seed + 1);
        const cv::Mat left_bits = naive::census(input.image, p),
                      right_bits = naive::census(right, p);
        const naive::Sums expected = naive::cost(input.image, right, left_bits, right_bits, p);
        const Case c{p, seed, input.name};
        const auto actual = costs_of(input.image, right, left_bits, right_bits, p);
        const auto padded_images = costs_of(padded(input.image, 1), padded(right, 2),
                                            padded(left_bits, 3), padded(right_bits, 4), p);
        for (int y = 0; y < size.height; ++y) {
          const cv::Mat1b row = cv::Mat_<std::uint8_t>(expected[y]);
          ASSERT_TRUE(same("cost", row, actual[y], c)) << "row " << y;
          ASSERT_TRUE(same("cost", row, padded_images[y], c)) << "padded, row " << y;
        }
      }
    }
  }
}

TEST(Cost, StartsAtAnyRow) {
  const cv::Mat1b left = random_image({21, 6}, 1), right = random_image({21, 6}, 2);
  Parameters p;
  p.disparity_range = 12;
  const cv::Mat left_bits = naive::census(left, p), right_bits = naive::census(right, p);
  const auto all = costs_of(left, right, left_bits, right_bits, p);
  Cost cost;  // used again: nothing may remain of earlier rows
  for (int first = 0; first < 6; ++first) {
    cost.start(left, right, left_bits, right_bits, p, first);
    for (int y = first; y < 6; ++y) {
      ASSERT_TRUE(same("cost", all[y], cost.next(), {p, 1, "noise"})) << first << ", row " << y;
    }
  }
}

// Two bits, and the best disparities of a pixel cost nothing.
TEST(Cost, SmallestCostIsZero) {
  for (const Parameters& p : cost_variants()) {
    const cv::Mat1b left = random_image({33, 4}, 7), right = random_image({33, 4}, 8);
    for (const cv::Mat1b& row :
         costs_of(left, right, naive::census(left, p), naive::census(right, p), p)) {
      double max = 0;
      cv::minMaxLoc(row, nullptr, &max);
      EXPECT_LE(max, kSgmMaxCost);
      for (int x = 0; x < row.cols; ++x) EXPECT_LT(cv::countNonZero(row.col(x)), row.rows) << x;
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
