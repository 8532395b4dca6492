// two_boards.launch with two virtual boards on USB: each pair has its own images, frames,
// calibration files and link.
#include <camera_calibration_parsers/parse.h>
#include <gtest/gtest.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <stereo_msgs/DisparityImage.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "fpga_stereo/core/spec.hpp"
#include "ros/rig.hpp"
#include "ros/usb_board.hpp"
#include "support/child.hpp"

namespace fpga_stereo::test {
namespace {

namespace fs = std::filesystem;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

cv::Mat1b grey(const sensor_msgs::Image& message) {
  return cv::Mat1b(static_cast<int>(message.height), static_cast<int>(message.width),
                   const_cast<std::uint8_t*>(message.data.data()), message.step)
      .clone();
}

/// Returns the number of pixels that differ from what core computes for the pair.
int wrong_pixels(const DisparityImage& message, const cv::Mat1w& expected) {
  int wrong = 0;
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      float value = 0;
      std::memcpy(&value, &message.image.data[y * message.image.step + x * 4], sizeof value);
      const bool is_valid = expected(y, x) != kNoDisparity;
      wrong += value != (is_valid ? static_cast<float>(expected(y, x) / 32.0) : -1) ? 1 : 0;
    }
  }
  return wrong;
}

/// One board, with what its node publishes.
class Pair {
 public:
  Pair(const std::string& name, const std::string& serial_number, const std::string& port,
       int shift, double focal_factor)
      : name_(name), nh_(name), messages_(synthetic_pair(kSize, shift, true)) {
    for (sensor_msgs::CameraInfo* info : {&messages_.left_info, &messages_.right_info}) {
      for (const int i : {0, 3, 5}) info->P[i] *= focal_factor;
    }
    expected_ = core_disparity(messages_, window_parameters());
    board = std::make_unique<UsbBoard>(serial_number, port,
                                       sim::GreyPair{grey(messages_.left), grey(messages_.right)});
  }

  bool calibrate() {
    return calibrate("left", messages_.left_info) && calibrate("right", messages_.right_info);
  }
  /// Waits for a disparity of a new frame, and checks it.
  void expect_disparity() {
    const std::size_t before = disparity.count();
    ASSERT_TRUE(eventually([&] { return disparity.count() > before + 1; }, 30)) << name_;
    const auto message = disparity.last();
    EXPECT_EQ(wrong_pixels(*message, expected_), 0) << name_;
    EXPECT_EQ(message->header.frame_id, name_ + "_left_optical_frame");
  }
  void expect_calibration_file(const std::string& folder) const {
    std::string camera;
    sensor_msgs::CameraInfo info;
    ASSERT_TRUE(camera_calibration_parsers::readCalibration(folder + "/" + name_ + "_right.yaml",
                                                            camera, info));
    EXPECT_NEAR(info.P[0], messages_.right_info.P[0], 1e-4) << name_;
    EXPECT_EQ(camera, name_ + "_right");
  }
  StereoStatus last_status() const { return status.count() == 0 ? StereoStatus() : *status.last(); }

  std::unique_ptr<UsbBoard> board;

 private:
  bool calibrate(const std::string& side, const sensor_msgs::CameraInfo& info) {
    sensor_msgs::SetCameraInfo call;
    call.request.camera_info = info;
    const std::string service = "/" + name_ + "/" + side + "/set_camera_info";
    return ros::service::waitForService(service, ros::Duration(30)) &&
           ros::service::call(service, call) && call.response.success;
  }

  const std::string name_;
  ros::NodeHandle nh_;
  PairMessages messages_;
  cv::Mat1w expected_;

 public:
  Listener<DisparityImage> disparity{nh_, "disparity"};
  Listener<StereoStatus> status{nh_, "fpga_stereo/status"};
};

TEST(TwoBoards, DoNotDisturbEachOther) {
  const std::string folder = "/tmp/fpga_stereo_two_boards_" + std::to_string(getpid());
  fs::create_directories(folder);
  std::ofstream(folder + "/config.yaml") << "image_width: 160\nimage_height: 120\nbackend: board\n";
  Pair front("front", "FS000001", "1-1", 12, 1.0);
  Pair rear("rear", "FS000002", "1-2", 20, 1.1);
  std::vector<std::string> environment = sim::VirtualFt232h::environment();
  environment.push_back("ROS_HOME=" + folder);
  tools::Child roslaunch(
      {"roslaunch", "fpga_stereo", "two_boards.launch", "front:=usb:serial=FS000001",
       "rear:=usb:serial=FS000002", "config:=" + folder + "/config.yaml"},
      environment, "roslaunch is missing");

  ASSERT_TRUE(front.calibrate());
  ASSERT_TRUE(rear.calibrate());
  front.expect_disparity();
  rear.expect_disparity();
  front.expect_calibration_file(folder + "/camera_info");
  rear.expect_calibration_file(folder + "/camera_info");

  const int replugs = ros::param::param("~replugs", 10);
  const ros::WallDuration pause(ros::param::param("~pause", 0.0));
  for (int i = 0; i < replugs; ++i) {
    pause.sleep();
    rear.board->replug(std::chrono::milliseconds(300));
    rear.expect_disparity();
    front.expect_disparity();
  }
  ASSERT_TRUE(rear.status.any([&](const StereoStatus& s) {
    return s.board_opened == static_cast<std::uint64_t>(replugs) + 1;
  })) << rear.last_status().board_opened;
  const StereoStatus s = front.last_status();
  EXPECT_EQ(s.board_opened, 1U);
  EXPECT_EQ(s.dropped_link, 0U);
  EXPECT_NE(s.board.find("FS000001"), std::string::npos) << s.board;
  EXPECT_NE(rear.last_status().board.find("FS000002"), std::string::npos)
      << rear.last_status().board;

  roslaunch.send_signal(SIGINT);
  roslaunch.wait();
  fs::remove_all(folder);
}

}  // namespace
}  // namespace fpga_stereo::test
