#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/stages.hpp"
#include "fpga_stereo/core/calibration.hpp"
#include "support/compare.hpp"
#include "support/data_test.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

cv::Mat rectified_of(const cv::Mat& raw, const Mesh& mesh) {
  cv::Mat out;
  rectify(raw, mesh, cv::Range::all(), out);
  return out;
}

/// Returns a mesh that moves every pixel by (x, y) / 128 px.
Mesh shifted(cv::Size size, int x, int y) {
  Mesh mesh = Mesh::shift(size, 0);
  mesh.nodes = cv::Vec2s(static_cast<short>(x), static_cast<short>(y));
  return mesh;
}

Mesh random_mesh(cv::Size size, int max_units, unsigned seed) {
  Mesh mesh = shifted(size, 0, 0);
  cv::RNG(seed).fill(mesh.nodes, cv::RNG::UNIFORM, -max_units, max_units + 1);
  return mesh;
}

TEST(Rectify, IdentityChangesNothing) {
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {33, 18}}) {
    const cv::Mat1b grey = random_image(size, 1);
    const cv::Mat3b color = random_color_image(size, 2);
    EXPECT_TRUE(same("rectify", grey, rectified_of(grey, Mesh::shift(size, 0))));
    EXPECT_TRUE(same("rectify", color, rectified_of(color, Mesh::shift(size, 0))));
  }
}

TEST(Rectify, ShiftByWholePixels) {
  const cv::Mat1b raw = random_image({20, 5}, 3);
  cv::Mat1b expected(raw.size(), std::uint8_t{0});
  raw.colRange(4, 20).copyTo(expected.colRange(0, 16));
  EXPECT_TRUE(same("rectify", expected, rectified_of(raw, Mesh::shift(raw.size(), 4))));
  expected = 0;
  raw.colRange(0, 16).copyTo(expected.colRange(4, 20));
  EXPECT_TRUE(same("rectify", expected, rectified_of(raw, Mesh::shift(raw.size(), -4))));
  EXPECT_EQ(cv::countNonZero(rectified_of(raw, Mesh::shift(raw.size(), 128))), 0);
}

// The result is (sum + 512) >> 10; the weights add up to 1024.
TEST(Rectify, RoundingByHand) {
  const cv::Mat1b raw = (cv::Mat1b(1, 3) << 0, 1, 0);
  const auto first = [&](int thirty_seconds) {
    return rectified_of(raw, shifted(raw.size(), 4 * thirty_seconds, 0)).at<std::uint8_t>(0, 0);
  };
  EXPECT_EQ(first(15), 0);
  EXPECT_EQ(first(16), 1) << "half rounds up";
  EXPECT_EQ(first(48), 1);
  EXPECT_EQ(first(49), 0);
  const cv::Mat1b step = (cv::Mat1b(2, 2) << 0, 255, 0, 255);
  // 5/32 of 255 is 39.84.
  EXPECT_EQ(rectified_of(step, shifted({2, 2}, 20, 0)).at<std::uint8_t>(0, 0), 40);
  const cv::Mat1b four = (cv::Mat1b(2, 2) << 10, 20, 30, 40);
  EXPECT_EQ(rectified_of(four, shifted({2, 2}, 64, 64)).at<std::uint8_t>(0, 0), 25);
  EXPECT_EQ(rectified_of(four, shifted({2, 2}, 32, 0)).at<std::uint8_t>(0, 0), 13)
      << "12.5 is rounded up";
  EXPECT_EQ(rectified_of(four, shifted({2, 2}, 0, 32)).at<std::uint8_t>(0, 0), 15);
}

TEST(Rectify, TapsOutsideAreZero) {
  const cv::Mat1b white(3, 3, std::uint8_t{255});
  const cv::Mat out = rectified_of(white, shifted({3, 3}, -64, -64));
  EXPECT_EQ(out.at<std::uint8_t>(0, 0), 64) << "one of four taps is inside: 63.75";
  EXPECT_EQ(out.at<std::uint8_t>(0, 1), 128) << "two taps are inside: 127.5";
  EXPECT_EQ(out.at<std::uint8_t>(1, 0), 128);
  EXPECT_EQ(out.at<std::uint8_t>(1, 1), 255);
  const cv::Mat other = rectified_of(white, shifted({3, 3}, 64, 64));
  EXPECT_EQ(other.at<std::uint8_t>(2, 2), 64);
  EXPECT_EQ(other.at<std::uint8_t>(2, 0), 128);
  EXPECT_EQ(other.at<std::uint8_t>(0, 2), 128);
}

TEST(Rectify, EqualsTheNaiveModel) {
  unsigned seed = 1400;
  for (const cv::Size size : {cv::Size(1, 1), {1, 12}, {12, 1}, {7, 9}, {40, 27}}) {
    for (const int max_units : {60, 1500, 32767}) {
      const Mesh mesh = random_mesh(size, max_units, ++seed);
      const Case c{{}, seed, "nodes up to " + std::to_string(max_units)};
      for (const NamedImage& input : extreme_images(size, seed)) {
        const cv::Mat expected = naive::rectify(input.image, mesh);
        ASSERT_TRUE(same("rectify", expected, rectified_of(input.image, mesh), c)) << input.name;
        ASSERT_TRUE(same("rectify", expected, rectified_of(padded(input.image, seed), mesh), c));
      }
      const cv::Mat3b color = random_color_image(size, seed);
      const cv::Mat expected = naive::rectify(color, mesh);
      ASSERT_TRUE(same("rectify", expected, rectified_of(color, mesh), c));
      ASSERT_TRUE(same("rectify", expected, rectified_of(padded(color, seed), mesh), c));
    }
  }
}

TEST(Rectify, RawImageOfAnotherSize) {
  const Mesh mesh = random_mesh({30, 21}, 900, 15);
  for (const cv::Size size : {cv::Size(3, 2), {50, 10}, {29, 40}}) {
    const cv::Mat1b raw = random_image(size, 16);
    EXPECT_TRUE(same("rectify", naive::rectify(raw, mesh), rectified_of(raw, mesh), {{}, 16, ""}));
  }
}

TEST(Rectify, WritesTheGivenRowsOnly) {
  const cv::Mat1b raw = random_image({17, 11}, 4);
  const Mesh mesh = random_mesh(raw.size(), 500, 4);
  cv::Mat out = padded(cv::Mat1b(raw.size(), std::uint8_t{99}), 5);
  cv::Mat expected = out.clone();
  naive::rectify(raw, mesh).rowRange(3, 8).copyTo(expected.rowRange(3, 8));
  rectify(raw, mesh, {3, 8}, out);
  EXPECT_TRUE(same("rectify", expected, out, {{}, 4, "rows 3 .. 7"}));
}

using RectifyData = DataTest;

/// Returns the mean absolute difference from cv::remap with the exact map, in grey levels, over the
/// pixels whose source lies in the raw image.
double difference_from_remap(const CameraCalibration& camera, const Mesh& mesh,
                             const cv::Mat1b& raw) {
  cv::Mat map_x, map_y;
  cv::initUndistortRectifyMap(cv::Mat1d(3, 3, const_cast<double*>(camera.K.data())), camera.D,
                              cv::Mat1d(3, 3, const_cast<double*>(camera.R.data())),
                              cv::Mat1d(3, 4, const_cast<double*>(camera.P.data())), raw.size(),
                              CV_32FC1, map_x, map_y);
  cv::Mat exact;
  cv::remap(raw, exact, map_x, map_y, cv::INTER_LINEAR);
  const cv::Mat inside =
      (map_x >= 0) & (map_y >= 0) & (map_x <= raw.cols - 1) & (map_y <= raw.rows - 1);
  EXPECT_GT(cv::countNonZero(inside), raw.rows * raw.cols / 2);
  cv::Mat difference;
  cv::absdiff(exact, rectified_of(raw, mesh), difference);
  return cv::mean(difference, inside)[0];
}

TEST_F(RectifyData, IsCloseToRemapWithTheExactMap) {
  const auto expect_close = [](const CalibrationPair& cameras, const ImagePair& images) {
    const auto rectification = make_stereo_rectification(cameras.left, cameras.right, 0);
    ASSERT_TRUE(rectification) << rectification.error().message;
    EXPECT_LE(difference_from_remap(cameras.left, rectification->left.mesh, images.left), 0.5);
    EXPECT_LE(difference_from_remap(cameras.right, rectification->right.mesh, images.right), 0.5);
  };
  for (const int frame : {0, kEurocFrames - 1}) {
    expect_close(euroc_calibration(), euroc_pair(frame));
  }
  for (const int number : {1, 14}) {
    expect_close(chessboard_calibration(), chessboard_pair(number));
  }
}

}  // namespace
}  // namespace fpga_stereo::test
