// The camera_info of one camera of a pair: from its topic, or from a calibration file if the camera
// driver has no calibration.
#pragma once

#include <message_filters/simple_filter.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <optional>
#include <string>

#include "core/log_limiter.hpp"
#include "core/thread_safety.hpp"
#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {

/// Hands camera_info messages to a synchronizer. With a file, it makes one for each image, and
/// publishes it on the camera_info topic unless somebody else does. subscribe() and unsubscribe()
/// are for one thread at a time, the rest is thread-safe.
class CameraInfoInput : public message_filters::SimpleFilter<sensor_msgs::CameraInfo> {
 public:
  /// `side` is "left" or "right"; `url` names the calibration file, none if it is empty.
  CameraInfoInput(const ros::NodeHandle& nh, const std::string& side, const std::string& url);

  /// Subscribes to the topic, or reads the file. Logs an error if the file cannot be read.
  void subscribe() FPGA_STEREO_EXCLUDES(mutex_);
  void unsubscribe() FPGA_STEREO_EXCLUDES(mutex_);
  bool is_from_file() const { return !url_.empty(); }
  /// Call for each image of the camera before it is handed on. The message made from the file has
  /// its stamp, and the frame `frame_id`.
  void on_image(const sensor_msgs::Image& image, const std::string& frame_id)
      FPGA_STEREO_EXCLUDES(mutex_);
  /// Says why the file cannot be used; nullopt if it can, or if there is none.
  std::optional<std::string> trouble() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  void read_file() FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns the line as it is to be logged, or nullopt if it is kept back: a subscriber that comes
  /// and goes has the file read each time.
  std::optional<std::string> admit(const char* cause, const std::string& line)
      FPGA_STEREO_EXCLUDES(mutex_);
  /// Warns once if the file is for images of another size.
  void check_size(const sensor_msgs::Image& image, cv::Size calibrated)
      FPGA_STEREO_EXCLUDES(mutex_);

  ros::NodeHandle nh_;
  const std::string side_, topic_, url_;
  ros::Subscriber subscriber_;

  mutable Mutex mutex_;
  std::optional<CameraCalibration> calibration_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::optional<std::string> trouble_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_size_checked_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  ros::Publisher publisher_ FPGA_STEREO_GUARDED_BY(mutex_);
  LogLimiter log_ FPGA_STEREO_GUARDED_BY(mutex_);
};

}  // namespace fpga_stereo
