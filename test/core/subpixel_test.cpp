#include <gtest/gtest.h>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

using Around = cv::Vec<std::uint16_t, 5>;

/// Returns the disparity of a kept pixel with this winner and these sums.
int refined(int winner, const Around& around, const Parameters& p = {}) {
  Selection s;
  create(s, {1, 1});
  s.winner(0, 0) = static_cast<std::uint8_t>(winner);
  s.around(0, 0) = around;
  cv::Mat1w out;
  subpixel(s, cv::Mat1b(1, 1, std::uint8_t{1}), p, cv::Range::all(), out);
  return out(0, 0);
}

/// Returns the sums of a parabola with its vertex at n / 32 px: (32 i - n)^2 + 100.
Around parabola(int n) {
  Around sums;
  for (int i = -2; i <= 2; ++i) {
    sums[i + 2] = static_cast<std::uint16_t>((32 * i - n) * (32 * i - n) + 100);
  }
  return sums;
}

TEST(Subpixel, RecoversTheVertexOfExactParabolas) {
  for (int n = -32; n <= 32; ++n) EXPECT_EQ(refined(20, parabola(n)), 20 * 32 + n) << n;
}

// The paper's Eq. 7 misprints the denominator as 20, which halves every offset. 10 recovers the
// vertex.
TEST(Subpixel, TheMisprintHalvesTheOffset) {
  EXPECT_EQ(naive::parabola_offset(parabola(12), 7, 10), 12);
  EXPECT_EQ(naive::parabola_offset(parabola(12), 7, 20), 6);
}

TEST(Subpixel, RoundsHalfAwayFromZero) {
  // num = 10, den = 448: 7 * 10 / 4480 px = 1/64 px.
  EXPECT_EQ(refined(20, {115, 1, 0, 1, 110}), 20 * 32 + 1);
  EXPECT_EQ(refined(20, {110, 1, 0, 1, 115}), 20 * 32 - 1);
  // num = 30, den = 448: 3/64 px.
  EXPECT_EQ(refined(20, {120, 1, 0, 1, 105}), 20 * 32 + 2);
  EXPECT_EQ(refined(20, {105, 1, 0, 1, 120}), 20 * 32 - 2);
  // num = 8, den = 448: 0.4 units.
  EXPECT_EQ(refined(20, {114, 1, 0, 1, 110}) - 20 * 32, 0);
}

TEST(Subpixel, ByHand) {
  // num = 200, den = 200: 0.7 px = 22.4 units.
  EXPECT_EQ(refined(20, {100, 0, 0, 0, 0}), 20 * 32 + 22);
  EXPECT_EQ(refined(20, {0, 0, 0, 0, 100}), 20 * 32 - 22);
}

TEST(Subpixel, ClampsTheOffsetToOnePixel) {
  // num = 30, den = 10: 2.1 px.
  EXPECT_EQ(refined(20, {10, 10, 0, 0, 0}), 21 * 32);
  EXPECT_EQ(refined(20, {0, 0, 0, 10, 10}), 19 * 32);
  EXPECT_EQ(refined(20, {52920, 52920, 0, 0, 0}), 21 * 32) << "no overflow";
  EXPECT_EQ(refined(20, {0, 0, 0, 52920, 52920}), 19 * 32) << "no overflow";
}

TEST(Subpixel, NoOffsetWhereTheParabolaDoesNotOpenUpwards) {
  EXPECT_EQ(refined(20, {7, 7, 7, 7, 7}), 20 * 32);
  EXPECT_EQ(refined(20, {9, 8, 7, 6, 5}), 20 * 32) << "den = 0";
  EXPECT_EQ(refined(20, {10, 90, 100, 80, 0}), 20 * 32) << "den < 0";
}

TEST(Subpixel, NoOffsetAtTheEndsOfTheRange) {
  for (const int range : {8, 12, 64, 256}) {
    Parameters p = window_parameters();
    p.disparity_range = range;
    for (int d = 0; d < range; ++d) {
      const bool is_inner = d >= 2 && d <= range - 3;
      ASSERT_EQ(refined(d, parabola(10), p), 32 * d + (is_inner ? 10 : 0)) << d << " of " << range;
      ASSERT_EQ(refined(d, parabola(-10), p), 32 * d - (is_inner ? 10 : 0)) << d << " of " << range;
    }
    EXPECT_EQ(refined(0, parabola(-32), p), 0);
    EXPECT_EQ(refined(range - 1, parabola(32), p), 32 * (range - 1));
  }
}

TEST(Subpixel, SwitchedOff) {
  Parameters p = window_parameters();
  p.subpixel = false;
  EXPECT_EQ(refined(20, parabola(10), p), 20 * 32);
}

TEST(Subpixel, MarksPixelsThatAreNotKept) {
  Selection s;
  create(s, {3, 1});
  s.winner = 7;
  std::fill(s.around.begin(), s.around.end(), Around(9, 4, 1, 4, 9));
  const cv::Mat1b kept = (cv::Mat1b(1, 3) << 1, 0, 1);
  cv::Mat1w out;
  for (const bool on : {true, false}) {
    Parameters p = window_parameters();
    p.subpixel = on;
    subpixel(s, kept, p, cv::Range::all(), out);
    EXPECT_EQ(out(0, 0), 7 * 32);
    EXPECT_EQ(out(0, 1), 0xFFFF);
    EXPECT_EQ(out(0, 2), 7 * 32);
  }
}

TEST(Subpixel, EqualsTheNaiveModel) {
  unsigned seed = 1000;
  for (const cv::Size size : {cv::Size(1, 1), {1, 8}, {9, 1}, {61, 40}}) {
    for (const int range : {8, 12, 64, 256}) {
      for (const int end : {4, 64, 52921}) {
        Parameters p = window_parameters();
        p.disparity_range = range;
        Selection s;
        create(s, size);
        cv::Mat1b kept(size);
        cv::RNG rng(++seed);
        rng.fill(s.winner, cv::RNG::UNIFORM, 0, range);
        rng.fill(s.around, cv::RNG::UNIFORM, 0, end);
        rng.fill(kept, cv::RNG::UNIFORM, 0, 2);
        const cv::Mat1w expected = naive::subpixel(s, kept, p);
        cv::Mat1w actual;
        subpixel(s, kept, p, cv::Range::all(), actual);
        ASSERT_TRUE(same("subpixel", expected, actual, {p, seed, "random"}));
        s.winner = padded(s.winner, 1);
        s.around = padded(s.around, 2);
        actual = padded(cv::Mat1w(size), 3);
        subpixel(s, padded(kept, 4), p, cv::Range::all(), actual);
        ASSERT_TRUE(same("subpixel", expected, actual, {p, seed, "padded"}));
      }
    }
  }
}

TEST(Subpixel, WritesTheGivenRowsOnly) {
  Selection s;
  create(s, {5, 6});
  s.winner = 9;
  std::fill(s.around.begin(), s.around.end(), Around(9, 4, 1, 4, 9));
  cv::Mat1w out(6, 5, std::uint16_t{1234});
  cv::Mat1w expected = out.clone();
  expected.rowRange(1, 4) = 9 * 32;
  subpixel(s, cv::Mat1b(6, 5, std::uint8_t{1}), window_parameters(), {1, 4}, out);
  EXPECT_TRUE(same("subpixel", expected, out));
}

}  // namespace
}  // namespace fpga_stereo::test
