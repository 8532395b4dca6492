#include <gtest/gtest.h>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

Parameters match_parameters(int range, int correlation,
                            CensusPattern pattern = CensusPattern::kSparse,
                            int census_window = 11) {
  Parameters p = window_parameters();
  p.disparity_range = range;
  p.correlation_window_size = correlation;
  p.census_pattern = pattern;
  p.census_window_size = census_window;
  return p;
}

/// Returns the sums that the stage computes for `first_row` and all rows below.
std::vector<cv::Mat1w> sums_of(const cv::Mat& left, const cv::Mat& right, const Parameters& p,
                               int first_row = 0) {
  Match match;
  match.start(left, right, p, first_row);
  std::vector<cv::Mat1w> rows;
  for (int y = first_row; y < left.rows; ++y) rows.push_back(match.next().clone());
  return rows;
}

::testing::AssertionResult same_sums(const naive::Sums& expected,
                                     const std::vector<cv::Mat1w>& actual, const Case& c) {
  const std::size_t first = expected.size() - actual.size();
  for (std::size_t i = 0; i < actual.size(); ++i) {
    cv::Mat1w row;
    expected[first + i].convertTo(row, CV_16U);
    auto result = same("match (y is d) of row " + std::to_string(first + i), row, actual[i], c);
    if (!result) return result;
  }
  return ::testing::AssertionSuccess();
}

/// Returns random census bits; unused bits of the words are 0.
cv::Mat random_bits(cv::Size size, const Parameters& p, unsigned seed) {
  return naive::census(random_image(size, seed), p);
}

TEST(Match, ThreePixelsByHand) {
  const Parameters p =
      match_parameters(8, 5, CensusPattern::kSparse, 5);  // 8 bits: h = 4 outside the image
  const cv::Mat left = (cv::Mat1i(1, 3) << 0b1, 0b11, 0b0);
  const cv::Mat right = (cv::Mat1i(1, 3) << 0b0, 0b1, 0b111);
  const cv::Mat1w sums = sums_of(left, right, p).at(0);
  ASSERT_EQ(sums.size(), cv::Size(3, 8));
  // The window spans the image, so every x has the sum of h(0), h(1) and h(2).
  const int expected[] = {1 + 1 + 3, 4 + 2 + 1, 4 + 4 + 0, 12, 12, 12, 12, 12};
  for (int d = 0; d < 8; ++d) {
    EXPECT_EQ(cv::countNonZero(sums.row(d) == expected[d]), 3) << "d " << d << ": " << sums.row(d);
  }
}

TEST(Match, WindowStopsAtItsRadius) {
  const Parameters p = match_parameters(8, 5, CensusPattern::kSparse, 5);
  cv::Mat1i left(9, 9, 0);
  const cv::Mat1i right(9, 9, 0);
  left(4, 4) = 0b111;
  const auto rows = sums_of(left, right, p);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 9; ++x) {
      const bool is_near = std::abs(x - 4) <= 2 && std::abs(y - 4) <= 2;
      ASSERT_EQ(rows[y](0, x), is_near ? 3 : 0) << x << " " << y;
    }
  }
}

TEST(Match, HalfTheBitsDifferLeftOfTheRightImage) {
  for (const auto& [pattern, half] :
       {std::pair(CensusPattern::kSparse, 12), {CensusPattern::kFull, 60}}) {
    const Parameters p = match_parameters(16, 5, pattern);
    const cv::Mat bits = naive::census(cv::Mat1b(9, 12, std::uint8_t{9}), p);
    const cv::Mat1w sums = sums_of(bits, bits, p).at(4);
    // The window has 5 rows. Of its columns x - 2 .. x + 2, those left of d have no right pixel.
    EXPECT_EQ(sums(0, 5), 0);
    EXPECT_EQ(sums(4, 5), 5 * half);
    EXPECT_EQ(sums(5, 5), 10 * half);
    EXPECT_EQ(sums(11, 5), 25 * half);
    EXPECT_EQ(sums(15, 5), 25 * half) << "no right pixel at all";
  }
}

// The largest possible sum: all 120 bits of 21 x 21 pixels differ.
TEST(Match, LargestSumIsExact) {
  const Parameters p = match_parameters(12, 21, CensusPattern::kFull);
  const cv::Size size(47, 25);
  const cv::Mat ones(size, CV_32SC4, cv::Scalar(-1, -1, -1, 0x00FFFFFF));
  const cv::Mat zeros(size, CV_32SC4, cv::Scalar::all(0));
  const auto sums = sums_of(ones, zeros, p);
  EXPECT_EQ(sums[12](0, 23), 52920);
  EXPECT_EQ(sums[12](11, 23), 52920);
  EXPECT_EQ(sums[0](0, 0), 11 * 11 * 120);
  EXPECT_TRUE(same_sums(naive::match(ones, zeros, p), sums, {p, 0, "all bits differ"}));

  const Parameters paper = match_parameters(12, 15, CensusPattern::kFull);
  EXPECT_EQ(sums_of(ones, zeros, paper)[12](0, 23), 27000);
}

TEST(Match, EveryCorrelationWindow) {
  unsigned seed = 200;
  for (int correlation = 5; correlation <= 21; correlation += 2) {
    for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
      const Parameters p = match_parameters(8, correlation, pattern);
      const cv::Mat left = random_bits({27, 24}, p, ++seed);
      const cv::Mat right = random_bits({27, 24}, p, ++seed);
      ASSERT_TRUE(
          same_sums(naive::match(left, right, p), sums_of(left, right, p), {p, seed, "random"}));
    }
  }
}

TEST(Match, EveryCensusWindow) {
  unsigned seed = 300;
  for (const int census_window : {5, 7, 9, 11}) {
    for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
      const Parameters p = match_parameters(12, 7, pattern, census_window);
      const cv::Mat left = random_bits({23, 11}, p, ++seed);
      const cv::Mat right = random_bits({23, 11}, p, ++seed);
      ASSERT_TRUE(
          same_sums(naive::match(left, right, p), sums_of(left, right, p), {p, seed, "random"}));
    }
  }
}

TEST(Match, EverySizeAndRangeEvenIfWiderThanTheImage) {
  unsigned seed = 400;
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {3, 4}, {13, 7}, {29, 5}}) {
    for (const int range : {8, 12, 16, 64, 128, 256}) {
      for (const int correlation : {5, 21}) {
        const Parameters p = match_parameters(range, correlation);
        const cv::Mat left = random_bits(size, p, ++seed);
        const cv::Mat right = random_bits(size, p, ++seed);
        const naive::Sums expected = naive::match(left, right, p);
        const Case c{p, seed, "random"};
        ASSERT_TRUE(same_sums(expected, sums_of(left, right, p), c));
        ASSERT_TRUE(same_sums(expected, sums_of(padded(left, 1), padded(right, 2), p), c))
            << "pitch above width";
      }
    }
  }
}

TEST(Match, ExtremeImages) {
  const cv::Size size(25, 18);
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    const Parameters p = match_parameters(12, 9, pattern);
    const auto images = extreme_images(size, 500);
    for (std::size_t i = 0; i < images.size(); ++i) {
      const NamedImage& other = images[(i + 3) % images.size()];
      const cv::Mat left = naive::census(images[i].image, p);
      const cv::Mat right = naive::census(other.image, p);
      const Case c{p, 500, images[i].name + " / " + other.name};
      ASSERT_TRUE(same_sums(naive::match(left, right, p), sums_of(left, right, p), c));
    }
  }
}

TEST(Match, EveryFirstRowGivesTheSameSums) {
  for (const int correlation : {5, 13, 21}) {
    const Parameters p = match_parameters(8, correlation);
    const cv::Mat left = random_bits({14, 30}, p, 600);
    const cv::Mat right = random_bits({14, 30}, p, 601);
    const naive::Sums expected = naive::match(left, right, p);
    for (int first = 0; first < 30; ++first) {
      const Case c{p, 600, "first row " + std::to_string(first)};
      ASSERT_TRUE(same_sums(expected, sums_of(left, right, p, first), c));
    }
  }
}

TEST(Match, CanBeStartedAgain) {
  Match match;
  unsigned seed = 700;
  for (const Parameters& p :
       {match_parameters(16, 21, CensusPattern::kFull), match_parameters(8, 5),
        match_parameters(64, 9), match_parameters(64, 9, CensusPattern::kFull),
        match_parameters(12, 15)}) {
    const cv::Size size(20 + static_cast<int>(++seed % 3), 9);
    const cv::Mat left = random_bits(size, p, seed);
    const cv::Mat right = random_bits(size, p, seed + 50);
    match.start(left, right, p, 2);
    std::vector<cv::Mat1w> rows;
    for (int y = 2; y < size.height; ++y) rows.push_back(match.next().clone());
    ASSERT_TRUE(same_sums(naive::match(left, right, p), rows, {p, seed, "reused"}));
  }
}

}  // namespace
}  // namespace fpga_stereo::test
