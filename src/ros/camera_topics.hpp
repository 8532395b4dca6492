// The topics and services of a camera driver, for the cameras of a board: raw images, camera_info
// and set_camera_info.
#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/SetCameraInfo.h>

#include <array>
#include <functional>
#include <optional>
#include <string>

#include "core/log_limiter.hpp"
#include "core/thread_safety.hpp"
#include "fpga_stereo/core/calibration.hpp"
#include "ros/board_settings.hpp"
#include "ros/calibration_store.hpp"
#include "ros/image_output.hpp"
#include "ros/source_pair.hpp"

namespace fpga_stereo {

/// Advertises the topics only while a board with cameras is connected. Thread-safe; its lock is a
/// leaf, and it is not held while anything is advertised, published or stored.
class CameraTopics {
 public:
  /// Which topics have subscribers.
  struct Demand {
    bool left = false, right = false;  // raw images
    bool info = false;                 // either camera_info
    bool any() const { return left || right || info; }
  };

  /// `changed` is called from ROS callbacks when a subscriber comes or goes.
  CameraTopics(const ros::NodeHandle& nh, const BoardSettings& settings,
               std::function<void()> changed);

  /// Advertises the topics and services, or withdraws them. One thread at a time.
  void set_advertised(bool is_advertised) FPGA_STEREO_EXCLUDES(mutex_);
  Demand demand() const FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns the present calibration: from set_camera_info or the calibration files. An
  /// uncalibrated camera has K[0] = 0 and the image size of the settings.
  StereoCalibration calibration() const FPGA_STEREO_EXCLUDES(mutex_);
  /// Publishes the images of the pair that are not empty, and the camera_infos. One thread at a
  /// time.
  void publish(const RawPair& pair) FPGA_STEREO_EXCLUDES(mutex_);

 private:
  /// What is advertised for one camera; all empty while nothing is.
  struct Camera {
    image_transport::Publisher images;
    ros::Publisher infos;
    ros::ServiceServer set_info;
  };

  Camera advertise(Side side);
  /// Answers set_camera_info.
  void set_calibration(Side side, const sensor_msgs::CameraInfo& info,
                       sensor_msgs::SetCameraInfoResponse& response) FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns the size of the cameras' images.
  cv::Size image_size() const FPGA_STEREO_EXCLUDES(mutex_);

  const BoardSettings& settings_;
  const std::function<void()> changed_;
  ros::NodeHandle nh_;
  ImageAdvertiser advertiser_;
  CalibrationStore store_;

  mutable Mutex mutex_;
  std::array<Camera, 2> cameras_ FPGA_STEREO_GUARDED_BY(mutex_);  // left, right
  bool is_advertised_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  /// Of the last images; nullopt: none yet since the topics were advertised.
  std::optional<cv::Size> seen_size_ FPGA_STEREO_GUARDED_BY(mutex_);
  LogLimiter log_ FPGA_STEREO_GUARDED_BY(mutex_);  // of set_camera_info
};

}  // namespace fpga_stereo
