// The calibration files of a board's cameras: what set_camera_info may do to them.
#include "ros/calibration_store.hpp"

#include <camera_calibration_parsers/parse.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>

#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "link/test_folder.hpp"
#include "ros/conversions.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

namespace fs = std::filesystem;

const cv::Size kSize(64, 48);

std::string contents(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A pair whose focal length identifies it.
StereoCalibration calibration_with(double focal) {
  const PairMessages messages = synthetic_pair(kSize, 3, true);
  StereoCalibration pair{*to_calibration(messages.left_info, "left"),
                         *to_calibration(messages.right_info, "right")};
  for (CameraCalibration* camera : {&pair.left, &pair.right}) camera->P[0] = camera->P[5] = focal;
  pair.right.P[3] = -0.1 * focal;
  return pair;
}

class CalibrationStoreTest : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return folder_ / name; }
  CalibrationUrls urls() const { return {"file://" + at("left.yaml"), at("right.yaml")}; }

  Result<std::string> set(Side side, const CameraCalibration& camera) {
    return store_.set(side, camera, kSize);
  }
  /// Sets both sides, in the order of cameracalibrator.py.
  bool set(const StereoCalibration& pair) {
    return set(Side::kLeft, pair.left) && set(Side::kRight, pair.right);
  }
  void expect_refused(const Result<std::string>& outcome, const std::string& text) {
    ASSERT_FALSE(outcome) << text;
    EXPECT_EQ(outcome.error().message, text);
  }
  /// Expects this calibration in effect, in the files, and nothing else in the folder.
  void expect_stored(const StereoCalibration& pair) {
    EXPECT_EQ(store_.calibration(), pair);
    CalibrationStore restarted("stereo_", urls());
    EXPECT_TRUE(restarted.load().empty());
    EXPECT_EQ(restarted.calibration(), pair);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 2);
  }

  TestFolder folder_;
  CalibrationStore store_{"stereo_", urls()};
  const StereoCalibration first_ = calibration_with(300), second_ = calibration_with(310);
};

TEST_F(CalibrationStoreTest, IsEmptyWithoutFiles) {
  const auto problems = store_.load();
  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[1].message, "the right camera is not calibrated: " + at("right.yaml") +
                                     ": cannot be read: No such file or directory");
  EXPECT_EQ(store_.calibration(), StereoCalibration());
}

TEST_F(CalibrationStoreTest, TakesBothSidesInTheOrderOfTheCalibrator) {
  const auto left = set(Side::kLeft, first_.left);
  ASSERT_TRUE(left) << left.error().message;
  EXPECT_EQ(*left,
            "the left calibration is accepted; it takes effect, and is saved, together with that "
            "of the right camera, which right/set_camera_info must bring next");
  EXPECT_EQ(store_.calibration(), StereoCalibration());
  EXPECT_FALSE(fs::exists(at("left.yaml")));
  const auto right = set(Side::kRight, first_.right);
  ASSERT_TRUE(right) << right.error().message;
  EXPECT_EQ(*right, "both calibrations are saved and take effect");
  expect_stored(first_);
  ASSERT_TRUE(set(second_));
  expect_stored(second_);
}

TEST_F(CalibrationStoreTest, TakesTheRightSideFirst) {
  ASSERT_TRUE(set(Side::kRight, first_.right) && set(Side::kLeft, first_.left));
  expect_stored(first_);
}

TEST_F(CalibrationStoreTest, WritesFilesThatRosReads) {
  ASSERT_TRUE(set(first_));
  std::string name;
  sensor_msgs::CameraInfo info;
  ASSERT_TRUE(camera_calibration_parsers::readCalibration(at("right.yaml"), name, info));
  EXPECT_EQ(name, "stereo_right");
  EXPECT_EQ(*to_calibration(info, "right"), first_.right);
}

TEST_F(CalibrationStoreTest, ReadsFilesThatRosWrites) {
  using camera_calibration_parsers::writeCalibration;
  ASSERT_TRUE(writeCalibration(at("left.yaml"), "any", to_camera_info(first_.left, {})));
  ASSERT_TRUE(writeCalibration(at("right.yaml"), "any", to_camera_info(first_.right, {})));
  EXPECT_TRUE(store_.load().empty());
  EXPECT_EQ(store_.calibration(), first_);
}

TEST_F(CalibrationStoreTest, RefusesOneSideThatCannotBeRight) {
  ASSERT_TRUE(set(first_));
  const auto expect_refused_side = [&](const std::function<void(CameraCalibration&)>& damage,
                                       const std::string& text) {
    for (const Side side : {Side::kLeft, Side::kRight}) {
      CameraCalibration camera = side == Side::kLeft ? second_.left : second_.right;
      damage(camera);
      expect_refused(set(side, camera), (side == Side::kLeft ? "left" : "right") + text);
    }
    expect_stored(first_);
  };
  expect_refused_side([](CameraCalibration& c) { c.K[2] = std::nan(""); },
                      " camera_info K has a value that is not finite");
  expect_refused_side([](CameraCalibration& c) { c.D[0] = HUGE_VAL; },
                      " camera_info D has a value that is not finite");
  expect_refused_side([](CameraCalibration& c) { c.K[0] = -1; },
                      " camera_info K[0] = -1: the focal length must be positive");
  expect_refused_side(
      [](CameraCalibration& c) {
        c.width = 2 * kSize.width;
        c.height = 2 * kSize.height;
      },
      " camera_info is for images of 128x96: those of the camera are 64x48");
  ASSERT_TRUE(set(second_)) << "refused sides are not waiting for the others";
  expect_stored(second_);
}

TEST_F(CalibrationStoreTest, RefusesSidesThatDoNotFitEachOther) {
  ASSERT_TRUE(set(first_));
  ASSERT_TRUE(set(Side::kLeft, second_.left));
  expect_refused(set(Side::kRight, first_.right),
                 "neither calibration takes effect: fx of left and right camera_info P differ (310 "
                 "and 300): they must be equal for a rectified pair");
  expect_stored(first_);
  ASSERT_TRUE(set(Side::kRight, second_.right)) << "waits for another left one";
  expect_stored(first_);
  ASSERT_TRUE(set(Side::kLeft, second_.left));
  expect_stored(second_);
}

TEST_F(CalibrationStoreTest, RefusesAPairThatTheNodeCouldNotRectify) {
  ASSERT_TRUE(set(first_));
  const auto expect_refused_pair = [&](double k1, const std::string& text) {
    StereoCalibration absurd = second_;
    for (CameraCalibration* camera : {&absurd.left, &absurd.right}) camera->D[0] = k1;
    ASSERT_TRUE(set(Side::kLeft, absurd.left));
    const auto right = set(Side::kRight, absurd.right);
    ASSERT_FALSE(right) << text;
    const std::string expected = "neither calibration takes effect: left camera: " + text;
    EXPECT_EQ(right.error().message.substr(0, expected.size()), expected);
    expect_stored(first_);
  };
  expect_refused_pair(1e9, "1 of 3072 rectified pixels lie in the raw image: allowed is 1 %");
  expect_refused_pair(-1000, "the rectification mesh is ");
}

TEST_F(CalibrationStoreTest, ForgetsAWaitingSideWhenFilesAreRead) {
  ASSERT_TRUE(set(first_));
  ASSERT_TRUE(set(Side::kLeft, second_.left));
  EXPECT_TRUE(store_.load().empty());
  ASSERT_TRUE(set(Side::kRight, second_.right)) << "waits";
  expect_stored(first_);
}

TEST_F(CalibrationStoreTest, KeepsTheFilesOnAFullDisk) {
  ASSERT_TRUE(set(first_));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit small{300, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  ASSERT_TRUE(set(Side::kLeft, second_.left));
  const auto right = set(Side::kRight, second_.right);
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  expect_refused(right, "neither calibration takes effect: " + at("left.yaml") +
                            ": cannot be written: File too large");
  expect_stored(first_);
}

TEST_F(CalibrationStoreTest, RefusesAFolderThatCannotBeWritten) {
  for (const std::string folder : {"/proc/fpga_stereo", "/dev/null"}) {
    CalibrationStore store("", {at("left.yaml"), folder + "/right.yaml"});
    ASSERT_TRUE(store.set(Side::kLeft, first_.left, kSize));
    const auto right = store.set(Side::kRight, first_.right, kSize);
    ASSERT_FALSE(right);
    EXPECT_EQ(
        right.error().message.rfind(
            "neither calibration takes effect: " + folder + "/right.yaml: cannot be written: ", 0),
        0U)
        << right.error().message;
    EXPECT_EQ(store.calibration(), StereoCalibration());
    EXPECT_TRUE(fs::is_empty(folder_.path())) << "no half of the pair, no temporary file";
  }
}

TEST_F(CalibrationStoreTest, PutsTheLeftFileBackIfTheRightOneCannotBeReplaced) {
  ASSERT_TRUE(set(first_));
  // A file that is mounted itself, as in a container, cannot be renamed.
  if (mount(at("right.yaml").c_str(), at("right.yaml").c_str(), nullptr, MS_BIND, nullptr) != 0) {
    GTEST_SKIP() << "this user may not mount anything";
  }
  ASSERT_TRUE(set(Side::kLeft, second_.left));
  const auto right = set(Side::kRight, second_.right);
  umount(at("right.yaml").c_str());
  expect_refused(right, "neither calibration takes effect: " + at("right.yaml") +
                            ": cannot be written: Device or resource busy");
  expect_stored(first_);
}

TEST_F(CalibrationStoreTest, RefusesToWriteOtherFiles) {
  const auto message = [&](const CalibrationUrls& urls) {
    CalibrationStore store("", urls);
    EXPECT_TRUE(store.set(Side::kLeft, first_.left, kSize));
    const auto right = store.set(Side::kRight, first_.right, kSize);
    return right ? "" : right.error().message;
  };
  EXPECT_EQ(message({at("pair.yaml"), "file://" + at("pair.yaml")}),
            "neither calibration takes effect: " + at("pair.yaml") +
                ": allowed are two files, one for each camera");
  EXPECT_EQ(
      message({at("left.ini"), at("right.ini")}),
      "neither calibration takes effect: " + at("left.ini") + ": allowed are .yaml and .yml files");
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(CalibrationStoreTest, IgnoresWhatACrashHasLeftBeforeItReplacedAFile) {
  ASSERT_TRUE(set(first_));
  const std::string new_left = *format_camera_info(second_.left, "stereo_left");
  const std::string new_right = *format_camera_info(second_.right, "stereo_right");
  std::ofstream(at("left.yaml.new")) << new_left.substr(0, 100);
  EXPECT_TRUE(store_.load().empty());
  EXPECT_EQ(store_.calibration(), first_);
  std::ofstream(at("left.yaml.new")) << new_left;
  std::ofstream(at("right.yaml.new")) << new_right;
  EXPECT_TRUE(store_.load().empty());
  EXPECT_EQ(store_.calibration(), first_);
  ASSERT_TRUE(set(second_));
  expect_stored(second_);
}

TEST_F(CalibrationStoreTest, CompletesWhatACrashHasInterruptedBetweenBothFiles) {
  ASSERT_TRUE(set(first_));
  std::ofstream(at("left.yaml")) << *format_camera_info(second_.left, "stereo_left");
  std::ofstream(at("right.yaml.new")) << *format_camera_info(second_.right, "stereo_right");
  EXPECT_TRUE(store_.load().empty());
  expect_stored(second_);
  // Not if they do not belong together.
  std::ofstream(at("right.yaml.new")) << *format_camera_info(first_.right, "stereo_right");
  EXPECT_TRUE(store_.load().empty());
  EXPECT_EQ(store_.calibration(), second_);
}

TEST_F(CalibrationStoreTest, NamesAFileThatCannotBeUsed) {
  ASSERT_TRUE(set(first_));
  std::string text = contents(at("left.yaml"));
  std::ofstream(at("left.yaml")) << text.replace(text.find("rows: 3"), 7, "rows: 2");
  const auto problems = store_.load();
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(problems[0].message, "the left camera is not calibrated: " + at("left.yaml") +
                                     ": camera_matrix.rows = \"2\": allowed is 3");
  EXPECT_EQ(store_.calibration().left, CameraCalibration());
  EXPECT_EQ(store_.calibration().right, first_.right);
}

}  // namespace
}  // namespace fpga_stereo::test
