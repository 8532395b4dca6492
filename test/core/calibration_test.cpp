#include "fpga_stereo/core/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/compare.hpp"
#include "support/data_test.hpp"

namespace fpga_stereo::test {
namespace {

/// Returns the simplest calibration that is allowed: a camera of a pair that is already rectified.
CameraCalibration ideal_camera(double p3) {
  CameraCalibration c;
  c.width = 160;
  c.height = 120;
  c.distortion_model = "plumb_bob";
  c.K = {250, 0, 80, 0, 250, 60, 0, 0, 1};
  c.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  c.P = {250, 0, 80, p3, 0, 250, 60, 0, 0, 0, 1, 0};
  return c;
}

const CameraCalibration kLeft = ideal_camera(0);
const CameraCalibration kRight = ideal_camera(-25);

/// Expects that the pair is refused with this kind and a message that contains all of `words`.
void expect_refused(const CameraCalibration& left, const CameraCalibration& right,
                    const std::vector<std::string>& words,
                    ErrorKind kind = ErrorKind::kCalibration) {
  const auto rectification = make_stereo_rectification(left, right, 0);
  ASSERT_FALSE(rectification) << "accepted: " << words.front();
  EXPECT_EQ(rectification.error().kind, kind) << rectification.error().message;
  for (const std::string& word : words) {
    EXPECT_NE(rectification.error().message.find(word), std::string::npos)
        << "\"" << word << "\" is not in: " << rectification.error().message;
  }
}

using Change = std::function<void(CameraCalibration&)>;

/// Expects that the change is refused in either camera, and that the message names the camera.
void expect_refused(const Change& change, const std::vector<std::string>& words,
                    ErrorKind kind = ErrorKind::kCalibration) {
  for (const std::string camera : {"left", "right"}) {
    CameraCalibration left = kLeft;
    CameraCalibration right = kRight;
    change(camera == "left" ? left : right);
    std::vector<std::string> all = words;
    all.push_back(camera);
    expect_refused(left, right, all, kind);
    const Status status = validate(camera == "left" ? left : right, camera);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().kind, kind);
  }
}

TEST(Calibration, IdealPairMovesNothing) {
  const auto rectification = make_stereo_rectification(kLeft, kRight, 0);
  ASSERT_TRUE(rectification) << rectification.error().message;
  const Mesh identity = Mesh::shift({160, 120}, 0);
  EXPECT_TRUE(same("left", identity.nodes, rectification->left.mesh.nodes));
  EXPECT_TRUE(same("right", identity.nodes, rectification->right.mesh.nodes));
  EXPECT_EQ(rectification->left.mesh.size, cv::Size(160, 120));
  EXPECT_LT(rectification->left.deviation.max, 1e-9);
}

TEST(Calibration, Geometry) {
  CameraCalibration right = kRight;
  right.P[2] = 83;
  const auto rectification = make_stereo_rectification(kLeft, right, 5);
  ASSERT_TRUE(rectification) << rectification.error().message;
  EXPECT_EQ(rectification->geometry.image_size, cv::Size(160, 120));
  EXPECT_EQ(rectification->geometry.fx, 250);
  EXPECT_EQ(rectification->geometry.fy, 250);
  EXPECT_EQ(rectification->geometry.cx, 80);
  EXPECT_EQ(rectification->geometry.cx_right, 83);
  EXPECT_EQ(rectification->geometry.cy, 60);
  EXPECT_DOUBLE_EQ(rectification->geometry.baseline, 0.1);
  EXPECT_EQ(rectification->min_disparity, 5);
}

TEST(Calibration, GeometryWithBinningAndRegionOfInterest) {
  CameraCalibration left = kLeft;
  CameraCalibration right = kRight;
  for (CameraCalibration* c : {&left, &right}) {
    c->binning_x = c->binning_y = 2;
    c->roi = {20, 10, 100, 80};
  }
  const auto rectification = make_stereo_rectification(left, right, 0);
  ASSERT_TRUE(rectification) << rectification.error().message;
  EXPECT_EQ(rectification->geometry.image_size, cv::Size(50, 40));
  EXPECT_EQ(rectification->left.mesh.size, cv::Size(50, 40));
  EXPECT_EQ(rectification->geometry.fx, 125);
  EXPECT_EQ(rectification->geometry.cx, 30);
  EXPECT_EQ(rectification->geometry.cy, 25);
  EXPECT_DOUBLE_EQ(rectification->geometry.baseline, 0.1)
      << "the baseline does not depend on the image size";
}

TEST(Calibration, MinimumDisparityShiftsTheRightMesh) {
  for (const int minimum : {-128, -7, 1, 128}) {
    const auto rectification = make_stereo_rectification(kLeft, kRight, minimum);
    ASSERT_TRUE(rectification) << rectification.error().message;
    const cv::Size size(160, 120);
    EXPECT_TRUE(same("left", Mesh::shift(size, 0).nodes, rectification->left.mesh.nodes));
    EXPECT_TRUE(same("right", Mesh::shift(size, -minimum).nodes, rectification->right.mesh.nodes));
    EXPECT_TRUE(
        same("unshifted", Mesh::shift(size, 0).nodes, rectification->right_unshifted.nodes));
    const StereoRectification identity = identity_rectification(rectification->geometry, minimum);
    EXPECT_TRUE(same("right", identity.right.mesh.nodes, rectification->right.mesh.nodes));
    EXPECT_TRUE(same("left", identity.left.mesh.nodes, rectification->left.mesh.nodes));
    EXPECT_TRUE(
        same("unshifted", identity.right_unshifted.nodes, rectification->right_unshifted.nodes));
    EXPECT_EQ(identity.min_disparity, minimum);
    EXPECT_EQ(identity.geometry.baseline, rectification->geometry.baseline);
  }
}

TEST(Calibration, OfARectifiedImageFollowsFromPAlone) {
  CameraCalibration left = kLeft, right = kRight;
  for (CameraCalibration* camera : {&left, &right}) {
    camera->K = {200, 0, 70, 0, 210, 50, 0, 0, 1};
    camera->D = {0.5, 0.1, std::nan("")};
    camera->distortion_model = "equidistant";
    camera->R = {0, 1, 0, -1, 0, 0, 0, 0, 1};
    camera->binning_x = 2;
    camera->roi = {20, 10, 100, 80};
  }
  for (const int minimum : {0, 5}) {
    const auto pair = make_stereo_rectification(rectified_calibration(left),
                                                rectified_calibration(right), minimum);
    ASSERT_TRUE(pair) << pair.error().message;
    const StereoRectification identity = identity_rectification(pair->geometry, minimum);
    EXPECT_TRUE(same("left", identity.left.mesh.nodes, pair->left.mesh.nodes));
    EXPECT_TRUE(same("right", identity.right.mesh.nodes, pair->right.mesh.nodes));
    EXPECT_EQ(pair->geometry.image_size, cv::Size(50, 80));
    EXPECT_EQ(pair->geometry.fx, 125);
    EXPECT_EQ(pair->geometry.fy, 250);
    EXPECT_EQ(pair->geometry.cx, 30);
    EXPECT_DOUBLE_EQ(pair->geometry.baseline, 0.1);
  }
}

TEST(CalibrationRefusal, OfARectifiedImageNamesWhatTheCameraInfoLacks) {
  CameraCalibration camera = kLeft;
  camera.P = {};
  EXPECT_NE(validate(rectified_calibration(camera), "left").error().message.find("P[0] = 0"),
            std::string::npos);
  EXPECT_EQ(validate(rectified_calibration({}), "left").error().kind, ErrorKind::kUncalibrated);
}

TEST(CalibrationRefusal, EmptyCameraInfoIsUncalibrated) {
  expect_refused([](CameraCalibration& c) { c = {}; }, {"uncalibrated", "K[0] = 0"},
                 ErrorKind::kUncalibrated);
}

TEST(CalibrationRefusal, ImageLargerThanThePipelineAllows) {
  expect_refused(
      [](CameraCalibration& c) {
        c.width = 1'000'000;
        c.height = 1'000'000;
      },
      {"1000000x1000000", "1920x1200"}, ErrorKind::kImageSize);
}

TEST(CalibrationRefusal, RegionOfInterestAndBinningAtTheLimitsOfInt) {
  expect_refused([](CameraCalibration& c) { c.roi = {-5, 0, 20, 20}; }, {"roi"});
  expect_refused([](CameraCalibration& c) { c.roi = {10, 10, 0x7FFFFFFF, 20}; }, {"roi"});
  expect_refused([](CameraCalibration& c) { c.binning_x = -1; }, {"binning -1"});
}

TEST(CalibrationRefusal, RefusesReflections) {
  expect_refused([](CameraCalibration& c) { c.R = {1, 0, 0, 0, -1, 0, 0, 0, 1}; },
                 {"R is not a rotation", "determinant -1"});
}

TEST(CalibrationRefusal, ThirdRowOfProjection) {
  expect_refused([](CameraCalibration& c) { c.P[10] = 0; }, {"P has the third row 0 0 0"});
}

TEST(CalibrationRefusal, Uncalibrated) {
  expect_refused([](CameraCalibration& c) { c.K[0] = 0; }, {"uncalibrated", "K[0]"},
                 ErrorKind::kUncalibrated);
  expect_refused([](CameraCalibration& c) { c.K = c.R = {}, c.P = {}, c.D.clear(); },
                 {"uncalibrated"}, ErrorKind::kUncalibrated);
}

TEST(CalibrationRefusal, NotFinite) {
  const std::vector<double> values{std::nan(""), INFINITY, -INFINITY};
  for (const double value : values) {
    for (std::size_t i = 0; i < 9; ++i) {
      expect_refused([=](CameraCalibration& c) { c.K[i] = value; }, {"camera_info K", "finite"});
      expect_refused([=](CameraCalibration& c) { c.R[i] = value; }, {"camera_info R", "finite"});
    }
    for (std::size_t i = 0; i < 12; ++i) {
      expect_refused([=](CameraCalibration& c) { c.P[i] = value; }, {"camera_info P", "finite"});
    }
    for (std::size_t i = 0; i < 5; ++i) {
      const Change change = [=](CameraCalibration& c) {
        c.D.assign(5, 0.0);
        c.D[i] = value;
      };
      expect_refused(change, {"camera_info D", "finite"});
    }
  }
}

TEST(CalibrationRefusal, FocalLengths) {
  expect_refused([](CameraCalibration& c) { c.K[0] = -250; }, {"K[0]", "-250"});
  expect_refused([](CameraCalibration& c) { c.K[4] = 0; }, {"K[4]"});
  expect_refused([](CameraCalibration& c) { c.P[0] = 0; }, {"P[0]"});
  expect_refused([](CameraCalibration& c) { c.P[5] = -1; }, {"P[5]", "-1"});
}

TEST(CalibrationRefusal, Distortion) {
  const auto set = [](const std::string& model, std::size_t length) -> Change {
    return [=](CameraCalibration& c) {
      c.distortion_model = model;
      c.D.assign(length, 0.001);
    };
  };
  expect_refused(set("equidistant", 4), {"distortion_model", "equidistant", "plumb_bob"});
  expect_refused(set("", 5), {"distortion_model"});
  expect_refused(set("plumb_bob", 4), {"camera_info D", "4", "plumb_bob", "5"});
  expect_refused(set("plumb_bob", 8), {"camera_info D", "8", "plumb_bob", "5"});
  expect_refused(set("rational_polynomial", 5), {"camera_info D", "rational_polynomial", "8"});
  expect_refused(set("rational_polynomial", 14), {"camera_info D", "14", "8"});
}

TEST(CalibrationRefusal, ZeroDistortionNeedsNoModel) {
  CameraCalibration left = kLeft;
  left.distortion_model = "";
  for (const std::size_t length : {0, 4, 5}) {
    left.D.assign(length, 0.0);
    EXPECT_TRUE(make_stereo_rectification(left, kRight, 0)) << length;
  }
}

TEST(CalibrationRefusal, MatrixThatIsNotARotation) {
  expect_refused([](CameraCalibration& c) { c.R = {}; }, {"camera_info R", "rotation"});
  expect_refused([](CameraCalibration& c) { c.R[0] = 1.1; }, {"camera_info R", "rotation"});
  expect_refused([](CameraCalibration& c) { c.R[1] = 0.1; }, {"camera_info R", "rotation"});
}

TEST(CalibrationRefusal, SizeAndRegionOfInterest) {
  expect_refused([](CameraCalibration& c) { c.width = 0; }, {"width x height", "0x120"});
  expect_refused([](CameraCalibration& c) { c.height = -3; }, {"width x height", "160x-3"});
  for (const cv::Rect& roi : {cv::Rect(1, 0, 160, 120),
                              {0, 1, 160, 120},
                              {-1, 0, 10, 10},
                              {100, 100, 61, 5},
                              {200, 0, 5, 5},
                              {5, 5, 0, 0}}) {
    expect_refused([=](CameraCalibration& c) { c.roi = roi; }, {"roi", "160x120"});
  }
  expect_refused([](CameraCalibration& c) { c.binning_x = 161; }, {"binning", "161"});
}

TEST(CalibrationRefusal, CamerasThatDoNotMatch) {
  const auto changed = [](std::size_t i, double difference) {
    CameraCalibration right = kRight;
    right.P[i] += difference;
    return right;
  };
  expect_refused(kLeft, changed(0, 0.5), {"fx", "P", "250", "250.5"});
  expect_refused(kLeft, changed(5, 0.5), {"fy", "P", "250", "250.5"});
  expect_refused(kLeft, changed(6, 0.25), {"cy", "P", "60", "60.25"});
  EXPECT_TRUE(make_stereo_rectification(kLeft, changed(6, 1e-4), 0))
      << "a difference from rounding in a file is allowed";

  CameraCalibration narrow = kRight;
  narrow.width = 150;
  expect_refused(kLeft, narrow, {"left and right", "160x120", "150x120"});
  CameraCalibration binned = kRight;
  binned.binning_x = binned.binning_y = 2;
  expect_refused(kLeft, binned, {"160x120", "80x60"});
}

TEST(CalibrationRefusal, Baseline) {
  expect_refused(kLeft, ideal_camera(0), {"right camera_info P[3] = 0", "negative"});
  expect_refused(kLeft, ideal_camera(25), {"right camera_info P[3] = 25", "swapped"});
}

TEST(CalibrationRefusal, CameraThatSeesNothing) {
  for (const int min_disparity : {0, 100}) {
    SCOPED_TRACE(min_disparity);
    CameraCalibration left = kLeft, right = kRight;
    left.K[5] += 0.5;  // the last row is outside, and no row is on the edge
    right.K[5] += 0.5;
    for (const double shift : {158.0, 159.0}) {  // 2 and 1 columns of 160
      left.K[2] = kLeft.K[2] + shift;
      right.K[2] = kRight.K[2] + shift;
      const auto both = make_stereo_rectification(left, right, min_disparity);
      const auto one = make_stereo_rectification(kLeft, right, min_disparity);
      if (shift == 158) {
        EXPECT_TRUE(both && one);
        continue;
      }
      ASSERT_FALSE(both || one);
      EXPECT_EQ(both.error().kind, ErrorKind::kCalibration);
      EXPECT_EQ(
          both.error().message,
          "left camera: 119 of 19200 rectified pixels lie in the raw image: allowed is 1 % or "
          "more");
      EXPECT_EQ(one.error().message,
                "right camera: 119 of 19200 rectified pixels lie in the raw image: allowed is 1 % "
                "or more");
    }
  }
}

using CalibrationData = DataTest;

TEST_F(CalibrationData, EurocGeometry) {
  const CalibrationPair pair = euroc_calibration();
  const auto rectification = make_stereo_rectification(pair.left, pair.right, 0);
  ASSERT_TRUE(rectification) << rectification.error().message;
  EXPECT_EQ(rectification->geometry.image_size, cv::Size(752, 480));
  EXPECT_NEAR(rectification->geometry.fx, 436.23, 0.01);
  EXPECT_NEAR(rectification->geometry.cx, 364.44, 0.01);
  EXPECT_NEAR(rectification->geometry.cy, 256.95, 0.01);
  EXPECT_NEAR(rectification->geometry.baseline, 0.11008, 1e-5);
  EXPECT_EQ(rectification->geometry.cx, rectification->geometry.cx_right);
}

TEST_F(CalibrationData, ChessboardGeometry) {
  const CalibrationPair pair = chessboard_calibration();
  const auto rectification = make_stereo_rectification(pair.left, pair.right, 0);
  ASSERT_TRUE(rectification) << rectification.error().message;
  EXPECT_NEAR(rectification->geometry.fx, 516.58, 0.01);
  EXPECT_NEAR(rectification->geometry.cx, 336.58, 0.01);
  EXPECT_NEAR(rectification->geometry.cy, 244.41, 0.01);
  EXPECT_NEAR(rectification->geometry.baseline, 0.0832, 1e-4);
}

}  // namespace
}  // namespace fpga_stereo::test
