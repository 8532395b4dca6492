#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

constexpr std::uint16_t kNone = kNoDisparity;
const cv::Point kCentre(20, 10);

/// The 15 pixels of the masked median of kCentre, in raster order.
std::vector<cv::Point> mask() {
  std::vector<cv::Point> points;
  for (const int y : {6, 8, 10, 12, 14}) {
    for (const int x : {14, 20, 26}) points.emplace_back(x, y);
  }
  return points;
}

/// A flat image, and disparities that would be the median if another pixel were included.
struct Scene {
  Scene() : left(21, 41, std::uint8_t{100}), disparity(21, 41, std::uint16_t{9999}) {}
  /// Makes the pixels of the mask from `first` on different from the centre.
  void exclude_from(std::size_t first) {
    for (std::size_t i = first; i < 15; ++i) {
      if (mask()[i] != kCentre) left(mask()[i]) = 200;
    }
  }
  std::uint16_t median_at(cv::Point pixel) const {
    cv::Mat1w out;
    masked_median(left, disparity, parameters, cv::Range::all(), out);
    return out(pixel);
  }
  Parameters parameters;
  cv::Mat1b left;
  cv::Mat1w disparity;
};

TEST(MaskedMedian, TakesTheMiddleOf15Pixels) {
  Scene scene;
  std::vector<cv::Point> pixels = mask();
  for (unsigned repetition = 0; repetition < 5; ++repetition) {
    for (int i = 0; i < 15; ++i) scene.disparity(pixels[i]) = static_cast<std::uint16_t>(10 * i);
    EXPECT_EQ(scene.median_at(kCentre), 70);
    std::shuffle(pixels.begin(), pixels.end(), std::mt19937(repetition));
  }
}

TEST(MaskedMedian, TakesTheLowerOfTwoMiddleValues) {
  const std::vector<cv::Point> pixels = mask();
  for (const int n : {1, 2, 3, 4, 8}) {
    Scene scene;
    scene.exclude_from(static_cast<std::size_t>(n - 1));  // and the centre, which is number 7
    int value = 0;
    for (int i = 0; i < n - 1; ++i) {
      scene.disparity(pixels[i]) = static_cast<std::uint16_t>(10 * value++);
    }
    scene.disparity(kCentre) = static_cast<std::uint16_t>(10 * value);
    EXPECT_EQ(scene.median_at(kCentre), 10 * ((n - 1) / 2)) << n << " pixels";
  }
}

TEST(MaskedMedian, IncludesPixelsOfSimilarGrey) {
  for (const int limit : {0, 1, 6}) {
    for (const int difference : {-100, -7, -6, -2, -1, 0, 1, 2, 6, 7, 100}) {
      Scene scene;
      scene.parameters.median_difference = limit;
      scene.exclude_from(1);
      scene.left(mask()[0]) = static_cast<std::uint8_t>(100 + difference);
      scene.disparity(kCentre) = 500;
      scene.disparity(mask()[0]) = 7;
      EXPECT_EQ(scene.median_at(kCentre), std::abs(difference) <= limit ? 7 : 500)
          << limit << " " << difference;
    }
  }
}

TEST(MaskedMedian, IncludesAllPixelsAtTheLargestDifference) {
  Scene scene;
  scene.parameters.median_difference = 255;
  scene.left(kCentre) = 0;
  scene.disparity(kCentre) = 1;
  scene.left.setTo(255, scene.left == 100);
  EXPECT_EQ(scene.median_at(kCentre), 9999);
  scene.parameters.median_difference = 254;
  EXPECT_EQ(scene.median_at(kCentre), 1);
}

TEST(MaskedMedian, LeavesOutPixelsOutsideTheImage) {
  Scene scene;
  // The corner has 2 x 3 of the 15 pixels.
  int value = 0;
  for (const int y : {0, 2, 4}) {
    for (const int x : {0, 6}) scene.disparity(y, x) = static_cast<std::uint16_t>(value++);
  }
  EXPECT_EQ(scene.median_at({0, 0}), 2);
  value = 0;
  for (const int y : {16, 18, 20}) {
    for (const int x : {34, 40}) scene.disparity(y, x) = static_cast<std::uint16_t>(value++);
  }
  EXPECT_EQ(scene.median_at({40, 20}), 2);
}

TEST(MaskedMedian, MissingDisparitiesAreTheLargest) {
  const std::vector<cv::Point> pixels = mask();
  for (const int missing : {0, 6, 7, 8, 15}) {
    Scene scene;
    scene.disparity = 320;
    for (int i = 0; i < missing; ++i) scene.disparity(pixels[i]) = kNone;
    EXPECT_EQ(scene.median_at(kCentre), missing <= 7 ? 320 : kNone) << missing;
  }
}

TEST(Median, TakesTheMiddleOf25Pixels) {
  cv::Mat1w disparity(9, 9, std::uint16_t{9999});
  for (int i = 0; i < 25; ++i) {
    disparity(2 + i / 5, 2 + i % 5) = static_cast<std::uint16_t>(10 * (7 * i % 25));
  }
  cv::Mat1w out;
  median(disparity, cv::Range::all(), out);
  EXPECT_EQ(out(4, 4), 120);
}

// (0, 0) stands for 9 of the 25 pixels of the corner, (0, 1) and (0, 2) for 3 each.
TEST(Median, BordersAreReplicated) {
  cv::Mat1w disparity(6, 6, std::uint16_t{100});
  disparity(0, 0) = 1;
  disparity(0, 1) = 2;
  cv::Mat1w out;
  median(disparity, cv::Range::all(), out);
  EXPECT_EQ(out(0, 0), 100) << "12 of 25 are smaller";
  disparity(1, 1) = 3;
  median(disparity, cv::Range::all(), out);
  EXPECT_EQ(out(0, 0), 3) << "13 of 25 are smaller";
  EXPECT_EQ(out(5, 5), 100);
  disparity = 100;
  disparity(5, 5) = 1;
  disparity(5, 4) = 2;
  disparity(4, 4) = 3;
  median(disparity, cv::Range::all(), out);
  EXPECT_EQ(out(5, 5), 3);
  const cv::Mat1w single(1, 1, std::uint16_t{77});
  median(single, cv::Range::all(), out);
  EXPECT_TRUE(same("median", single, out));
}

TEST(Median, MissingDisparitiesAreTheLargest) {
  cv::Mat1w out;
  for (const int missing : {11, 12, 13, 25}) {
    cv::Mat1w disparity(5, 5, std::uint16_t{320});
    for (int i = 0; i < missing; ++i) disparity(i / 5, i % 5) = kNone;
    median(disparity, cv::Range::all(), out);
    EXPECT_EQ(out(2, 2), missing <= 12 ? 320 : kNone) << missing;
  }
}

cv::Mat1w random_disparity(cv::Size size, unsigned seed) {
  cv::Mat1w disparity(size);
  cv::RNG rng(seed);
  const int end = rng.uniform(2, 8161);
  for (std::uint16_t& value : disparity) {
    value = rng.uniform(0, 6) == 0 ? kNone : static_cast<std::uint16_t>(rng.uniform(0, end));
  }
  return disparity;
}

TEST(Median, EqualsTheNaiveModel) {
  unsigned seed = 1400;
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {3, 2}, {5, 4}, {31, 17}, {64, 33}}) {
    for (const int difference : {0, 6, 60, 255}) {
      Parameters p;
      p.median_difference = difference;
      const cv::Mat1w in = random_disparity(size, ++seed);
      const cv::Mat1b left = random_image(size, seed);
      const Case c{p, seed, "random"};
      cv::Mat1w out;
      masked_median(left, in, p, cv::Range::all(), out);
      ASSERT_TRUE(same("masked median", naive::masked_median(left, in, p), out, c));
      median(in, cv::Range::all(), out);
      ASSERT_TRUE(same("median", naive::median(in), out, c));
      out = padded(cv::Mat1w(size), 3);
      masked_median(padded(left, 1), padded(in, 2), p, cv::Range::all(), out);
      ASSERT_TRUE(same("masked median", naive::masked_median(left, in, p), out, c)) << "padded";
      median(padded(in, 2), cv::Range::all(), out);
      ASSERT_TRUE(same("median", naive::median(in), out, c)) << "padded";
    }
  }
}

TEST(Median, WritesTheGivenRowsOnly) {
  const cv::Mat1w in = random_disparity({20, 12}, 5);
  const cv::Mat1b left = random_image(in.size(), 6);
  const Parameters p;
  const auto expect_rows = [&](const cv::Mat1w& all,
                               const std::function<void(cv::Range, cv::Mat1w&)>& run) {
    cv::Mat1w out(in.size(), std::uint16_t{1234});
    cv::Mat1w expected = out.clone();
    all.rowRange(3, 7).copyTo(expected.rowRange(3, 7));
    const auto* data = out.data;
    run({3, 7}, out);
    EXPECT_EQ(out.data, data);
    EXPECT_TRUE(same("median", expected, out));
  };
  expect_rows(naive::masked_median(left, in, p),
              [&](cv::Range rows, cv::Mat1w& out) { masked_median(left, in, p, rows, out); });
  expect_rows(naive::median(in), [&](cv::Range rows, cv::Mat1w& out) { median(in, rows, out); });
}

}  // namespace
}  // namespace fpga_stereo::test
