#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "fpga_stereo/core/calibration.hpp"
#include "support/data_test.hpp"

namespace fpga_stereo::test {
namespace {

/// Returns a camera in which every field has an effect.
CameraCalibration camera(const std::string& model) {
  CameraCalibration c;
  c.width = 320;
  c.height = 240;
  c.distortion_model = model;
  c.D = {-0.28, 0.07, 0.002, -0.001, 0.01};
  if (model == "rational_polynomial") c.D = {0.3, -0.2, 0.001, 0.002, 0.05, 0.4, -0.1, 0.03};
  c.K = {230, 0, 158, 0, 228, 117, 0, 0, 1};
  cv::Matx33d R;
  cv::Rodrigues(cv::Vec3d(0.02, -0.03, 0.015), R);
  std::copy(R.val, R.val + 9, c.R.begin());
  c.P = {215, 0, 163, -21.5, 0, 217, 121, 0, 0, 0, 1, 0};
  return c;
}

template <std::size_t N>
cv::Mat1d matrix(const std::array<double, N>& values) {
  return cv::Mat1d(cv::Mat1d(std::vector<double>(values.begin(), values.end())).reshape(1, 3))
      .clone();
}

/// Returns the largest distance between two maps over a grid of pixels, in px.
double max_difference(const ExactMap& a, const ExactMap& b, cv::Size size) {
  double max = 0;
  for (int y = 0; y < size.height; y += 7) {
    for (int x = 0; x < size.width; x += 7) {
      const double distance = cv::norm(a(x, y) - b(x, y));
      if (!(distance <= max)) max = distance;  // keeps NaN
    }
  }
  return max;
}

ExactMap opencv_map(const CameraCalibration& c) {
  cv::Mat1f x, y;
  cv::initUndistortRectifyMap(matrix(c.K), c.D, matrix(c.R), matrix(c.P), {c.width, c.height},
                              CV_32FC1, x, y);
  return [=](double column, double row) -> cv::Point2d {
    const cv::Point at(static_cast<int>(column), static_cast<int>(row));
    return {x(at), y(at)};
  };
}

TEST(ExactMap, EqualsOpenCv) {
  for (const std::string model : {"plumb_bob", "rational_polynomial"}) {
    const CameraCalibration c = camera(model);
    EXPECT_LT(max_difference(exact_map(c), opencv_map(c), {c.width, c.height}), 1e-4) << model;
    CameraCalibration other = c;
    other.D[2] += 0.001;
    EXPECT_GT(max_difference(exact_map(other), opencv_map(c), {c.width, c.height}), 1e-2)
        << "a small change of a coefficient must show";
  }
}

TEST(ExactMap, IdealCameraGivesTheIdentity) {
  CameraCalibration c = camera("plumb_bob");
  c.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  c.P = {230, 0, 158, 0, 0, 228, 117, 0, 0, 0, 1, 0};
  const ExactMap identity = [](double x, double y) { return cv::Point2d(x, y); };
  for (const std::vector<double>& no_distortion :
       {std::vector<double>(), std::vector<double>(5, 0.0), std::vector<double>(4, 0.0)}) {
    c.D = no_distortion;
    EXPECT_LT(max_difference(exact_map(c), identity, {320, 240}), 1e-9);
  }
}

TEST(ExactMap, ShiftMovesTheRectifiedImageToTheRight) {
  const CameraCalibration c = camera("plumb_bob");
  const ExactMap map = exact_map(c);
  const ExactMap shifted = exact_map(c, 24);
  const ExactMap moved_back = [=](double x, double y) { return shifted(x + 24, y); };
  EXPECT_LT(max_difference(map, moved_back, {320, 240}), 1e-9);
}

// image_geometry subtracts the offset of the region of interest and then divides by the binning.
TEST(ExactMap, BinningAndRegionOfInterest) {
  for (const std::string model : {"plumb_bob", "rational_polynomial"}) {
    CameraCalibration c = camera(model);
    c.binning_x = 2;
    c.binning_y = 3;
    c.roi = {16, 9, 280, 210};
    EXPECT_EQ(c.image_size(), cv::Size(140, 70));

    CameraCalibration by_hand = camera(model);
    by_hand.width = 140;
    by_hand.height = 70;
    by_hand.K = {230 / 2.0, 0, (158 - 16) / 2.0, 0, 228 / 3.0, (117 - 9) / 3.0, 0, 0, 1};
    by_hand.P = {215 / 2.0, 0, (163 - 16) / 2.0, -21.5 / 2, 0, 217 / 3.0, (121 - 9) / 3.0, 0, 0, 0,
                 1,         0};
    EXPECT_LT(max_difference(exact_map(c), exact_map(by_hand), {140, 70}), 1e-9);
    EXPECT_GT(max_difference(exact_map(c), exact_map(camera(model)), {140, 70}), 5.0);
  }
}

TEST(ExactMap, BinningOfZeroAndOneAreEqual) {
  const CameraCalibration c = camera("plumb_bob");
  CameraCalibration one = c;
  one.binning_x = one.binning_y = 1;
  one.roi = {0, 0, 320, 240};
  EXPECT_EQ(one.image_size(), cv::Size(320, 240));
  EXPECT_EQ(c.image_size(), cv::Size(320, 240));
  EXPECT_EQ(max_difference(exact_map(c), exact_map(one), {320, 240}), 0);
}

TEST(ExactMap, ImageSizeRoundsDown) {
  CameraCalibration c = camera("plumb_bob");
  c.width = 321;
  c.height = 243;
  c.binning_x = c.binning_y = 2;
  EXPECT_EQ(c.image_size(), cv::Size(160, 121));
}

TEST(ExactMap, HasNoSourceBehindTheCamera) {
  CameraCalibration c = camera("plumb_bob");
  c.R = {1, 0, 0, 0, -1, 0, 0, 0, -1};  // looks backwards
  const cv::Point2d source = exact_map(c)(163, 121);
  EXPECT_FALSE(std::isfinite(source.x) && std::isfinite(source.y));
}

TEST(ExactMap, HomographyByHand) {
  const std::array<double, 9> matrix{2, 0, 10, 0, 4, 20, 0.01, 0, 1};
  const ExactMap map = exact_map(matrix);
  EXPECT_DOUBLE_EQ(map(0, 0).x, 10);
  EXPECT_DOUBLE_EQ(map(0, 0).y, 20);
  EXPECT_DOUBLE_EQ(map(100, 5).x, 210 / 2.0);
  EXPECT_DOUBLE_EQ(map(100, 5).y, 40 / 2.0);
  EXPECT_DOUBLE_EQ(exact_map(matrix, 3)(103, 5).x, 210 / 2.0);
}

TEST(ExactMap, HomographyBecomesAMesh) {
  const std::array<double, 9> matrix{1.01, 0.004, -2.5, -0.003, 0.99, 3.25, 1e-5, -2e-5, 1};
  const auto rectification = make_rectification(exact_map(matrix), {640, 480}, {640, 480}, "left");
  ASSERT_TRUE(rectification) << rectification.error().message;
  EXPECT_LE(rectification->deviation.max, 1.0 / 16);
  EXPECT_LE(rectification->deviation.rms, 1.0 / 32);
  EXPECT_EQ(rectification->mesh.nodes(0, 0), cv::Vec2s(-320, 416));
}

using ExactMapData = DataTest;

TEST_F(ExactMapData, EqualsOpenCvOnRealCalibrations) {
  for (const CalibrationPair& pair : {euroc_calibration(), chessboard_calibration()}) {
    for (const CameraCalibration* c : {&pair.left, &pair.right}) {
      EXPECT_LT(max_difference(exact_map(*c), opencv_map(*c), {c->width, c->height}), 5e-4);
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
