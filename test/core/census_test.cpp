#include <gtest/gtest.h>

#include "core/census_window.hpp"
#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

Parameters census_parameters(int size, CensusPattern pattern) {
  Parameters p = window_parameters();
  p.census_window_size = size;
  p.census_pattern = pattern;
  return p;
}

std::uint32_t word(const cv::Mat& bits, int x, int y, int channel = 0) {
  return bits.ptr<std::uint32_t>(y)[x * bits.channels() + channel];
}

cv::Mat census_of(const cv::Mat1b& image, const Parameters& p) {
  cv::Mat bits;
  census(image, p, cv::Range::all(), bits);
  return bits;
}

TEST(Census, NumberOfBits) {
  const int full[] = {24, 48, 80, 120};
  const int sparse[] = {8, 8, 24, 24};
  for (int i = 0; i < 4; ++i) {
    const int size = 5 + 2 * i;
    EXPECT_EQ(census_neighbours(census_parameters(size, CensusPattern::kFull)).size(), full[i])
        << size;
    EXPECT_EQ(census_neighbours(census_parameters(size, CensusPattern::kSparse)).size(), sparse[i])
        << size;
    const cv::Mat1b image(3, 4, std::uint8_t{0});
    EXPECT_EQ(census_of(image, census_parameters(size, CensusPattern::kFull)).channels(),
              (full[i] + 31) / 32);
    EXPECT_EQ(census_of(image, census_parameters(size, CensusPattern::kSparse)).type(), CV_32SC1);
  }
}

TEST(Census, NeighboursInRasterOrderWithoutTheCentre) {
  const std::vector<cv::Point> expected{{-2, -2}, {0, -2}, {2, -2}, {-2, 0},
                                        {2, 0},   {-2, 2}, {0, 2},  {2, 2}};
  EXPECT_EQ(census_neighbours(census_parameters(5, CensusPattern::kSparse)), expected);
  EXPECT_EQ(census_neighbours(census_parameters(7, CensusPattern::kSparse)), expected);
  const auto full = census_neighbours(census_parameters(11, CensusPattern::kFull));
  EXPECT_EQ(full.front(), cv::Point(-5, -5));
  EXPECT_EQ(full[59], cv::Point(-1, 0));
  EXPECT_EQ(full[60], cv::Point(1, 0));
  EXPECT_EQ(full.back(), cv::Point(5, 5));
}

// On a ramp that rises to the right, the neighbours on the left and no others are darker.
TEST(Census, RampByHand) {
  const cv::Mat1b image = ramp({9, 9}, 1, 0);
  // Full 5 x 5: rows 11000 11000 11.00 11000 11000, bit 0 first.
  const std::uint32_t full = 3U << 0 | 3U << 5 | 3U << 10 | 3U << 14 | 3U << 19;
  EXPECT_EQ(word(census_of(image, census_parameters(5, CensusPattern::kFull)), 4, 4), full);
  // Sparse 5 x 5: rows 100 1.0 100.
  EXPECT_EQ(word(census_of(image, census_parameters(5, CensusPattern::kSparse)), 4, 4),
            1U | 8U | 32U);
}

TEST(Census, RampOfTheWholeWindowByHand) {
  const cv::Mat bits = census_of(ramp({11, 11}, 0, 1), census_parameters(11, CensusPattern::kFull));
  // The ramp rises downwards, so only the 55 neighbours above are darker.
  EXPECT_EQ(word(bits, 5, 5, 0), 0xFFFFFFFFU);
  EXPECT_EQ(word(bits, 5, 5, 1), 0x007FFFFFU);
  EXPECT_EQ(word(bits, 5, 5, 2), 0U);
  EXPECT_EQ(word(bits, 5, 5, 3), 0U);
}

// 8 neighbours at distance 1, then 8 at distance 3, each in raster order.
TEST(Census, PatternOfSemiGlobalMatching) {
  const std::vector<cv::Point> expected{{-1, -1}, {0, -1}, {1, -1},  {-1, 0}, {1, 0},  {-1, 1},
                                        {0, 1},   {1, 1},  {-3, -3}, {0, -3}, {3, -3}, {-3, 0},
                                        {3, 0},   {-3, 3}, {0, 3},   {3, 3}};
  for (const int size : {5, 11}) {
    for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
      Parameters p = census_parameters(size, pattern);
      p.stereo_algorithm = StereoAlgorithm::kSgm;
      EXPECT_EQ(census_neighbours(p), expected);
      EXPECT_EQ(census_of(cv::Mat1b(3, 4, std::uint8_t{0}), p).type(), CV_32SC1);
    }
  }
}

TEST(Census, BitsOfSemiGlobalMatchingByHand) {
  const Parameters p;
  for (std::size_t k = 0; k < 16; ++k) {
    cv::Mat1b image(9, 9, std::uint8_t{50});
    image(cv::Point(4, 4) + census_neighbours(p)[k]) = 49;
    EXPECT_EQ(word(census_of(image, p), 4, 4), 1U << k) << k;
  }
  // Rows 100 1.0 100 on a ramp that rises to the right, at both distances.
  const std::uint32_t left = 1U | 8U | 32U;
  const cv::Mat bits = census_of(ramp({9, 9}, 1, 0), p);
  EXPECT_EQ(word(bits, 4, 4), left | left << 8);
  EXPECT_EQ(word(bits, 2, 4), left) << "the outer neighbours lie outside the image";
  EXPECT_EQ(word(bits, 0, 4), 0U);
}

TEST(Census, EqualNeighboursGiveZero) {
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    const cv::Mat bits =
        census_of(cv::Mat1b(13, 15, std::uint8_t{77}), census_parameters(11, pattern));
    EXPECT_EQ(cv::countNonZero(bits.reshape(1)), 0);
  }
}

TEST(Census, OutsideTheImageIsBitZero) {
  cv::Mat1b image(9, 9, std::uint8_t{0});
  image(0, 0) = 255;
  // Only the neighbours to the right of the corner and below it exist: bits 4, 6 and 7.
  const cv::Mat bits = census_of(image, census_parameters(5, CensusPattern::kSparse));
  EXPECT_EQ(word(bits, 0, 0), 16U | 64U | 128U);
  EXPECT_EQ(word(bits, 8, 8), 0U);
}

TEST(Census, DependsOnTheOrderOfValuesOnly) {
  const cv::Mat1b image = random_image({21, 17}, 3) / 2;
  const Parameters p = census_parameters(11, CensusPattern::kFull);
  EXPECT_TRUE(
      same("census", census_of(image, p), census_of(cv::Mat1b(image + 100), p), {p, 3, ""}));
}

/// Compares with the naive model, also if the row pitch exceeds the width.
::testing::AssertionResult equals_naive(const NamedImage& input, const Parameters& p,
                                        unsigned seed) {
  const cv::Mat expected = naive::census(input.image, p);
  const cv::Mat1b part = padded(input.image, seed);
  auto result = same("census", expected, census_of(input.image, p), {p, seed, input.name});
  if (!result) return result;
  return same("census", expected, census_of(part, p), {p, seed, input.name + ", padded"});
}

TEST(Census, EqualsTheNaiveModel) {
  unsigned seed = 100;
  for (const cv::Size size : {cv::Size(1, 1), {1, 13}, {13, 1}, {3, 2}, {7, 9}, {33, 19}}) {
    for (const int side : {5, 7, 9, 11}) {
      for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
        const Parameters p = census_parameters(side, pattern);
        for (const NamedImage& input : extreme_images(size, ++seed)) {
          ASSERT_TRUE(equals_naive(input, p, seed));
        }
      }
    }
  }
}

TEST(Census, EqualsTheNaiveModelOfSemiGlobalMatching) {
  unsigned seed = 200;
  const Parameters p;
  for (const cv::Size size : {cv::Size(1, 1), {1, 13}, {13, 1}, {3, 2}, {7, 9}, {33, 19}}) {
    for (const NamedImage& input : extreme_images(size, ++seed)) {
      ASSERT_TRUE(equals_naive(input, p, seed));
    }
  }
}

TEST(Census, WritesTheGivenRowsOnly) {
  const cv::Mat1b image = random_image({19, 12}, 5);
  const Parameters p = census_parameters(9, CensusPattern::kFull);
  const cv::Mat all = census_of(image, p);
  cv::Mat bits(all.size(), all.type(), cv::Scalar::all(-7));
  cv::Mat expected = bits.clone();
  all.rowRange(4, 9).copyTo(expected.rowRange(4, 9));
  const auto* data = bits.data;
  census(image, p, {4, 9}, bits);
  EXPECT_EQ(bits.data, data) << "the memory of an output of the right size is reused";
  EXPECT_TRUE(same("census", expected, bits, {p, 5, "rows 4 .. 8"}));
}

TEST(Census, WritesIntoAnOutputWithPitchAboveWidth) {
  const cv::Mat1b image = random_image({19, 12}, 6);
  const Parameters p = census_parameters(11, CensusPattern::kFull);
  const cv::Mat expected = naive::census(image, p);
  cv::Mat bits = padded(cv::Mat(expected.size(), expected.type(), cv::Scalar::all(0)), 6);
  census(image, p, cv::Range::all(), bits);
  EXPECT_TRUE(same("census", expected, bits, {p, 6, "padded output"}));
}

}  // namespace
}  // namespace fpga_stereo::test
