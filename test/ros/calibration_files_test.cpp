// Cameras whose driver has no calibration: the node takes it from files, and publishes it for
// others.
#include <camera_calibration_parsers/parse.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <stereo_msgs/DisparityImage.h>

#include <cstdio>
#include <cstring>

#include "fpga_stereo/core/spec.hpp"
#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::CameraInfo;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

class CalibrationFiles : public testing::Test {
 protected:
  CalibrationFiles() {
    ros::param::get("~files", files_);
    for (sensor_msgs::Image* image : {&pair_.left, &pair_.right}) image->header.frame_id = "cam0";
    pair_.right.header.frame_id = "cam1";
  }
  ~CalibrationFiles() override { remove_files(); }

  void remove_files() const {
    std::remove((files_ + "_left.yaml").c_str());
    std::remove((files_ + "_right.yaml").c_str());
  }
  void write_files() const {
    using camera_calibration_parsers::writeCalibration;
    ASSERT_TRUE(writeCalibration(files_ + "_left.yaml", "any", pair_.left_info));
    ASSERT_TRUE(writeCalibration(files_ + "_right.yaml", "any", pair_.right_info));
  }
  /// Publishes the images until the listener has a message of a new one.
  template <class Message>
  bool leads_to(const Listener<Message>& listener) {
    const std::size_t before = listener.count();
    return eventually([&] {
      publish();
      ros::WallDuration(0.1).sleep();
      return listener.count() > before;
    });
  }
  void publish() {
    pair_.left.header.stamp = pair_.right.header.stamp = ros::Time::now();
    left_.publish(pair_.left);
    right_.publish(pair_.right);
  }
  StereoStatus status_when(std::uint8_t state) const {
    eventually([&] { return status_.count() > 0 && status_.last()->state == state; }, 15);
    return status_.count() > 0 ? *status_.last() : StereoStatus();
  }
  /// Waits until the node has noticed that nobody wants anything.
  void wait_until_idle() const { status_when(StereoStatus::IDLE); }

  std::string files_;
  PairMessages pair_ = synthetic_pair(kSize, 12);
  ros::NodeHandle nh_{"front"};
  ros::Publisher left_ = nh_.advertise<sensor_msgs::Image>("port/image_raw", 10);
  ros::Publisher right_ = nh_.advertise<sensor_msgs::Image>("starboard/image_raw", 10);
  Listener<StereoStatus> status_{nh_, "fpga_stereo/status"};
};

TEST_F(CalibrationFiles, AreNamedIfTheyAreMissing) {
  remove_files();
  Listener<rosgraph_msgs::Log> log(nh_, "/rosout");
  ASSERT_TRUE(eventually(all_links_are_up));
  wait_until_idle();
  Listener<DisparityImage> disparity(nh_, "disparity");
  const StereoStatus status = status_when(StereoStatus::UNCALIBRATED);
  const std::string text = "the left camera is not calibrated: " + files_ +
                           "_left.yaml: cannot be read: No such file or directory";
  EXPECT_EQ(status.state, StereoStatus::UNCALIBRATED);
  EXPECT_EQ(status.state_text, text);
  EXPECT_TRUE(log.any([&](const rosgraph_msgs::Log& line) {
    return line.level == rosgraph_msgs::Log::ERROR && line.msg == text;
  }));
}

TEST_F(CalibrationFiles, CalibrateTheImages) {
  write_files();
  wait_until_idle();
  Listener<DisparityImage> disparity(nh_, "disparity");
  ASSERT_TRUE(leads_to(disparity));
  const auto message = disparity.last();
  EXPECT_EQ(message->header.frame_id, "cam0");
  EXPECT_EQ(message->header.stamp, pair_.left.header.stamp);
  EXPECT_FLOAT_EQ(message->f, static_cast<float>(pair_.right_info.P[0]));
  EXPECT_FLOAT_EQ(message->T, static_cast<float>(-pair_.right_info.P[3] / pair_.right_info.P[0]));
  const cv::Mat1w expected = core_disparity(pair_, {});
  int wrong = 0;
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      float value = 0;
      std::memcpy(&value, &message->image.data[y * message->image.step + x * 4], sizeof value);
      const bool is_valid = expected(y, x) != kNoDisparity;
      wrong += value != (is_valid ? static_cast<float>(expected(y, x) / 32.0) : -1);
    }
  }
  EXPECT_EQ(wrong, 0);
}

TEST_F(CalibrationFiles, ArePublishedWithTheStampsOfTheImages) {
  write_files();
  wait_until_idle();
  Listener<DisparityImage> disparity(nh_, "disparity");
  Listener<CameraInfo> left(nh_, "port/camera_info"), right(nh_, "starboard/camera_info");
  ASSERT_TRUE(leads_to(left));
  ASSERT_TRUE(leads_to(right));
  const auto left_info = left.with_stamp(pair_.left.header.stamp);
  const auto right_info = right.with_stamp(pair_.left.header.stamp);
  ASSERT_TRUE(left_info && right_info);
  EXPECT_EQ(left_info->header.frame_id, "cam0");
  EXPECT_EQ(right_info->header.frame_id, "cam0") << "image_geometry requires the left frame";
  EXPECT_EQ(left_info->width, pair_.left_info.width);
  EXPECT_EQ(left_info->P, pair_.left_info.P);
  EXPECT_EQ(right_info->P, pair_.right_info.P);
}

TEST_F(CalibrationFiles, OverrideADriverWithoutInterferingWithIt) {
  write_files();
  wait_until_idle();
  const ros::Publisher driver = nh_.advertise<CameraInfo>("port/camera_info", 10);
  Listener<CameraInfo> left(nh_, "port/camera_info");
  Listener<DisparityImage> disparity(nh_, "disparity");
  ASSERT_TRUE(leads_to(disparity));
  driver.publish(CameraInfo());  // uncalibrated
  ASSERT_TRUE(leads_to(disparity));
  EXPECT_EQ(left.count(), 1U) << "only that of the driver";
}

TEST_F(CalibrationFiles, OfAnotherSizeAreReported) {
  write_files();
  Listener<rosgraph_msgs::Log> log(nh_, "/rosout");
  ASSERT_TRUE(eventually(all_links_are_up));
  wait_until_idle();
  pair_ = synthetic_pair({80, 60}, 12);
  Listener<DisparityImage> disparity(nh_, "disparity");
  EXPECT_FALSE(leads_to(disparity));
  const StereoStatus status = status_when(StereoStatus::BAD_IMAGE);
  EXPECT_EQ(status.state_text.find("left image is 80x60: its camera_info says 160x120"),
            status.state_text.find("left image"))
      << status.state_text;
  EXPECT_TRUE(log.any([&](const rosgraph_msgs::Log& line) {
    return line.level == rosgraph_msgs::Log::ERROR &&
           line.msg == "the images of the left camera are 80x60, but the calibration in file://" +
                           files_ + "_left.yaml is for 160x120: calibrate at this size";
  }));
}

}  // namespace
}  // namespace fpga_stereo::test
