// The sub-pixel fit of semi-global matching.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kWidth = 40;
const cv::Point kPixel(25, 8);

/// What fit_subpixel reads. At first only kPixel is kept, and no census bit is set.
struct Scene {
  explicit Scene(int winner = 10) {
    parameters.disparity_range = 16;
    create(selection, left_bits.size());
    selection.winner = static_cast<std::uint8_t>(winner);
    kept(kPixel) = 1;
  }

  /// Sets the distances of `pixel` from h(first) on, by its winner. Pixels of one row meet the same
  /// right pixels, so the tests use pixels of different rows, or of columns far apart.
  void set_distances(cv::Point pixel, int first, const std::vector<int>& distances) {
    kept(pixel) = 1;
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const int d = selection.winner(pixel) + first + static_cast<int>(i);
      right_bits(pixel.y, pixel.x - d) = (1 << distances[i]) - 1;
    }
  }

  cv::Mat1w disparities() const {
    cv::Mat1w out;
    fit_subpixel(left_bits, right_bits, selection, kept, parameters, cv::Range::all(), out);
    return out;
  }
  /// Returns the offset of kPixel in 1/32 px.
  int offset() const { return disparities()(kPixel) - 32 * selection.winner(kPixel); }

  Parameters parameters;
  Selection selection;
  cv::Mat1i left_bits = cv::Mat1i(17, kWidth, 0);
  cv::Mat1i right_bits = cv::Mat1i(17, kWidth, 0);
  cv::Mat1b kept = cv::Mat1b(17, kWidth, std::uint8_t{0});
};

/// Returns the offset of a pixel on its own with distances h(-1), h(0), h(1).
int offset_of(int before, int centre, int after) {
  Scene scene;
  scene.set_distances(kPixel, -1, {before, centre, after});
  return scene.offset();
}

TEST(Fit, ByHand) {
  EXPECT_EQ(offset_of(8, 4, 6), 1) << "depth 4: 32 * 2 / (8 + 64) = 0.89";
  EXPECT_EQ(offset_of(6, 4, 8), -1);
  EXPECT_EQ(offset_of(16, 0, 0), 5) << "depth 16: 32 * 16 / (32 + 64) = 5.33";
  EXPECT_EQ(offset_of(0, 0, 16), -5);
  EXPECT_EQ(offset_of(7, 2, 7), 0);
}

/// Returns the offset of two pixels of a column that have these distances each.
int offset_of_two(int before, int centre, int after) {
  Scene scene;
  for (const cv::Point& pixel : {kPixel, kPixel + cv::Point(0, 1)}) {
    scene.set_distances(pixel, -1, {before, centre, after});
  }
  return scene.offset();
}

TEST(Fit, RoundsHalfAwayFromZero) {
  // Depth 32, so the offset is half the difference of the distances.
  EXPECT_EQ(offset_of_two(16, 0, 15), 1) << "1/2";
  EXPECT_EQ(offset_of_two(15, 0, 16), -1);
  EXPECT_EQ(offset_of_two(16, 0, 13), 2) << "3/2";
  EXPECT_EQ(offset_of_two(13, 0, 16), -2);
  EXPECT_EQ(offset_of_two(16, 0, 14), 1);
  EXPECT_EQ(offset_of_two(10, 1, 9), 1) << "depth 18: 64 / 100 = 0.64";
  EXPECT_EQ(offset_of_two(16, 15, 16), 0);
}

TEST(Fit, NoOffsetWithoutAMinimum) {
  EXPECT_EQ(offset_of(5, 5, 5), 0);
  EXPECT_EQ(offset_of(5, 5, 2), 0) << "depth 0";
  EXPECT_EQ(offset_of(2, 5, 5), 0);
  EXPECT_EQ(offset_of(9, 16, 0), 0) << "depth < 0";
  EXPECT_NE(offset_of(6, 5, 2), 0) << "depth 1";
}

TEST(Fit, NoOffsetAtTheEndsOfTheRange) {
  for (int winner = 0; winner < 16; ++winner) {
    Scene scene(winner);
    scene.set_distances(kPixel, -1, {16, 0, 0});
    EXPECT_EQ(scene.offset(), winner == 0 || winner == 15 ? 0 : 5) << winner;
  }
}

TEST(Fit, SwitchedOff) {
  Scene scene;
  scene.set_distances(kPixel, -1, {16, 0, 0});
  scene.parameters.subpixel = false;
  EXPECT_EQ(scene.disparities()(kPixel), 320);
  EXPECT_EQ(scene.disparities()(0, 0), kNoDisparity);
}

TEST(Fit, MarksPixelsThatAreNotKept) {
  Scene scene;
  scene.set_distances(kPixel, -1, {16, 0, 0});
  const cv::Mat1w out = scene.disparities();
  EXPECT_EQ(cv::countNonZero(out != kNoDisparity), 1);
  EXPECT_EQ(out(kPixel), 325);
}

// A match outside the right image has distance 8.
TEST(Fit, OutsideTheRightImage) {
  Scene scene(10);
  scene.kept = 0;
  scene.kept(3, 10) = 1;  // d = 11 would be right pixel -1
  EXPECT_EQ(scene.disparities()(3, 10), 320 - 3) << "depth 8: -32 * 8 / (16 + 64) = -3.2";
}

// Pixel q has the same winner as kPixel, or one that differs by 1, so that its distances move by 1.
TEST(Fit, SumsDistancesAtTheSameDisparity) {
  for (const int difference : {-1, 0, 1}) {
    Scene scene;
    const cv::Point q = kPixel + cv::Point(0, 3);
    scene.selection.winner(q) = static_cast<std::uint8_t>(10 + difference);
    scene.set_distances(q, -1 - difference, {12, 0, 6});  // at disparities 9, 10 and 11
    EXPECT_EQ(scene.offset(), 2) << difference << ": 32 * 6 / (24 + 64) = 2.18";
  }
}

// Two neighbours away winners differ by up to 2, and the sums would need h(3) or h(-3). They repeat
// h(2) and h(-2).
TEST(Fit, RepeatsTheOutermostDistance) {
  for (const int sign : {-1, 1}) {
    Scene scene;
    const cv::Point in_row = kPixel + cv::Point(4, 0), in_column = in_row + cv::Point(0, 1);
    scene.selection.winner(in_row) = static_cast<std::uint8_t>(10 + sign);
    scene.selection.winner(in_column) = static_cast<std::uint8_t>(10 + 2 * sign);
    scene.kept(in_row) = 1;
    scene.set_distances(kPixel, -1, {16, 0, 16});
    scene.set_distances(in_column, -2 * sign, {16});  // at disparity 10
    // At 10 + sign, 10 and 10 - sign: 0, 16 and, repeated, 16. With those of kPixel 16, 16 and 32.
    EXPECT_EQ(scene.offset(), 5 * sign);
  }
}

TEST(Fit, LeavesOutPixelsThatAreNotKeptOrDifferByTwo) {
  const cv::Point q = kPixel + cv::Point(0, 1);
  Scene scene;
  scene.set_distances(q, -1, {16, 0, 0});
  EXPECT_EQ(scene.offset(), 5);
  scene.kept(q) = 0;
  EXPECT_EQ(scene.offset(), 0);
  for (const int difference : {-2, 2}) {
    for (const cv::Point step : {cv::Point(0, 1), cv::Point(4, 0)}) {
      Scene far;
      const cv::Point other = kPixel + step;
      far.selection.winner(other) = static_cast<std::uint8_t>(10 + difference);
      far.set_distances(other, -1 - difference, {16, 0, 16});
      EXPECT_EQ(far.offset(), 0) << difference << " at " << step;
    }
  }
}

TEST(Fit, WindowIsNineByEleven) {
  for (int dy = -7; dy <= 7; ++dy) {
    if (dy == 0) continue;
    for (int dx = -6; dx <= 6; ++dx) {
      Scene scene;
      for (int x = -6; x <= 6; ++x) scene.kept(kPixel + cv::Point(x, 0)) = 1;
      scene.set_distances(kPixel + cv::Point(dx, dy), -1, {16, 0, 0});
      const bool is_inside = std::abs(dx) <= 4 && std::abs(dy) <= 5;
      EXPECT_EQ(scene.offset(), is_inside ? 5 : 0) << dx << ", " << dy;
    }
  }
}

// Columns are summed first, by the winner of the pixel in the row.
TEST(Fit, ReachesAPixelThroughTheRowOnly) {
  Scene scene;
  scene.set_distances(kPixel + cv::Point(1, 1), -1, {16, 0, 0});
  EXPECT_EQ(scene.offset(), 0) << "(1, 0) is not kept";
  scene.kept(kPixel + cv::Point(0, 1)) = 1;
  EXPECT_EQ(scene.offset(), 0) << "(0, 1) is no way";
  scene.kept(kPixel + cv::Point(1, 0)) = 1;
  EXPECT_EQ(scene.offset(), 5);
  scene.selection.winner(kPixel + cv::Point(1, 0)) = 12;
  EXPECT_EQ(scene.offset(), 0) << "(1, 0) differs by 2";
}

/// Returns the offset where all pixels of the window have distances h(-1), h(0) and h(1).
int offset_of_window(int before, int centre, int after) {
  const cv::Size size(60, 21);
  Selection s;
  create(s, size);
  Parameters p;
  p.disparity_range = 16;
  // The bits of right pixel x depend on x % 3, so that every third left pixel has these distances.
  // Only those are kept: 3 of 9 columns, 33 pixels of a window.
  cv::Mat1i left_bits(size, 0), right_bits(size, 0);
  cv::Mat1b kept(size, std::uint8_t{0});
  s.winner = 9;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int distances[] = {centre, after, before};  // of right pixels x, x - 1, x + 1
      right_bits(y, x) = (1 << distances[(60 - x) % 3]) - 1;
      kept(y, x) = x % 3 == 0 ? 1 : 0;
    }
  }
  cv::Mat1w out;
  fit_subpixel(left_bits, right_bits, s, kept, p, cv::Range::all(), out);
  return out(10, 30) - 32 * 9;
}

// The vertex of a V with slope a is (c(-1) - c(1)) / (2 a). Here the damping of 64 counts little.
TEST(Fit, FindsTheVertexOfAV) {
  EXPECT_EQ(offset_of_window(8, 0, 8), 0);
  // 33 pixels: slope 8, vertex 1/4: 32 * 33 * 4 / (2 * 33 * 8 + 64) = 7.14
  EXPECT_EQ(offset_of_window(10, 2, 6), 7);
  EXPECT_EQ(offset_of_window(6, 2, 10), -7);
  // Vertex 1/2: 32 * 33 * 8 / (2 * 33 * 8 + 64) = 14.27
  EXPECT_EQ(offset_of_window(12, 4, 4), 14);
  EXPECT_EQ(offset_of_window(4, 4, 12), -14);
}

TEST(Fit, ClampsTheOffsetToOnePixel) {
  // Depth 33 * 1: 32 * 33 * 16 / (66 + 64) = 130.
  EXPECT_EQ(offset_of_window(16, 15, 0), 32);
  EXPECT_EQ(offset_of_window(0, 15, 16), -32);
}

TEST(Fit, SlowlyRisingDistancesAreDamped) {
  EXPECT_EQ(offset_of(1, 0, 0), 0) << "32 / (2 + 64) = 0.48 instead of 16";
  EXPECT_EQ(offset_of(4, 0, 0), 2) << "128 / (8 + 64) = 1.78 instead of 16";
}

TEST(Fit, EqualsTheNaiveModel) {
  unsigned seed = 1100;
  for (const cv::Size size : {cv::Size(1, 1), {1, 8}, {9, 1}, {5, 4}, {47, 23}}) {
    for (const int range : {8, 12, 64, 256}) {
      for (const int spread : {1, 3, 6}) {
        for (const int keep : {1, 4}) {
          Parameters p;
          p.disparity_range = range;
          Selection s;
          create(s, size);
          cv::Mat1b kept(size);
          cv::Mat1i left_bits(size), right_bits(size);
          cv::RNG rng(++seed);
          const int first = rng.uniform(0, range - spread + 1);
          rng.fill(s.winner, cv::RNG::UNIFORM, first, first + spread);
          rng.fill(left_bits, cv::RNG::UNIFORM, 0, 0x10000);
          rng.fill(right_bits, cv::RNG::UNIFORM, 0, 0x10000);
          for (std::uint8_t& k : kept) k = rng.uniform(0, keep + 1) != 0 ? 1 : 0;
          const cv::Mat1w expected = naive::fit_subpixel(left_bits, right_bits, s, kept, p);
          cv::Mat1w actual;
          fit_subpixel(left_bits, right_bits, s, kept, p, cv::Range::all(), actual);
          ASSERT_TRUE(same("fit", expected, actual, {p, seed, "random"}));
          s.winner = padded(s.winner, 1);
          actual = padded(cv::Mat1w(size), 2);
          fit_subpixel(padded(left_bits, 3), padded(right_bits, 4), s, padded(kept, 5), p,
                       cv::Range::all(), actual);
          ASSERT_TRUE(same("fit", expected, actual, {p, seed, "padded"}));
        }
      }
    }
  }
}

TEST(Fit, WritesTheGivenRowsOnly) {
  Scene scene;
  scene.kept = 1;
  scene.set_distances(kPixel, -1, {16, 0, 0});
  cv::Mat1w out(scene.kept.size(), std::uint16_t{1234});
  cv::Mat1w expected = out.clone();
  scene.disparities().rowRange(5, 10).copyTo(expected.rowRange(5, 10));
  const auto* data = out.data;
  fit_subpixel(scene.left_bits, scene.right_bits, scene.selection, scene.kept, scene.parameters,
               {5, 10}, out);
  EXPECT_EQ(out.data, data);
  EXPECT_TRUE(same("fit", expected, out));
}

}  // namespace
}  // namespace fpga_stereo::test
