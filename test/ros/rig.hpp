// A camera pair made of publishers, and listeners that wait: what tests of a running node share.
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <fpga_stereo/StereoStatus.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <functional>
#include <mutex>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::test {

/// Waits until `condition` holds; false after `seconds`.
bool eventually(const std::function<bool()>& condition, double seconds = 10);
/// True where `condition` holds all the time.
bool always(const std::function<bool()>& condition, double seconds = 1);

/// The messages of one topic, in order.
template <class Message>
class Listener {
 public:
  using Ptr = typename Message::ConstPtr;

  Listener(ros::NodeHandle& nh, const std::string& topic)
      : subscriber_(nh.subscribe<Message>(topic, 100, [this](const Ptr& message) {
          const std::lock_guard<std::mutex> lock(mutex_);
          messages_.push_back(message);
        })) {}

  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }
  Ptr last() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.empty() ? nullptr : messages_.back();
  }
  /// Waits for a message that fulfils `condition`.
  bool any(const std::function<bool(const Message&)>& condition) const {
    return eventually([&] {
      const std::lock_guard<std::mutex> lock(mutex_);
      return std::any_of(messages_.begin(), messages_.end(),
                         [&](const Ptr& message) { return condition(*message); });
    });
  }
  /// The message with this stamp, waiting for it; null where it does not come.
  Ptr with_stamp(const ros::Time& stamp, double seconds = 10) const {
    Ptr found;
    eventually(
        [&] {
          const std::lock_guard<std::mutex> lock(mutex_);
          for (const Ptr& message : messages_) {
            if (message->header.stamp == stamp) found = message;
          }
          return found != nullptr;
        },
        seconds);
    return found;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Ptr> messages_;
  ros::Subscriber subscriber_;
};

/// The four messages of a frame, to be spoilt as a test likes.
struct PairMessages {
  sensor_msgs::Image left, right;
  sensor_msgs::CameraInfo left_info, right_info;

  void set_stamp(const ros::Time& stamp);
};

/// A textured pair with this disparity everywhere, and a calibration with some lens distortion
/// where `distorted`.
PairMessages synthetic_pair(cv::Size size, int disparity, bool distorted = false);

/// The disparity that core computes for the pair.
cv::Mat1w core_disparity(const PairMessages& pair, const Parameters& parameters);

/// The publishers of a camera pair in the namespace "stereo", where the node under test is called
/// "fpga_stereo".
class Rig {
 public:
  Rig();

  ros::NodeHandle& nh() { return nh_; }
  /// Publishes with a fresh stamp, or with those of the messages where `keep_stamps`.
  ros::Time publish(PairMessages pair, bool keep_stamps = false);
  /// Waits until the node listens to all four topics and sends to every listener; or listens to
  /// none.
  bool node_listens();
  bool node_is_deaf();
  /// Sets parameters by name and text; the configuration that the node answers.
  dynamic_reconfigure::Config reconfigure(const std::string& name, const std::string& value);
  /// Waits for a status that fulfils `condition`; the last one seen.
  StereoStatus status_when(const std::function<bool(const StereoStatus&)>& condition,
                           double seconds = 15);
  /// A status made after this call.
  StereoStatus status();

 private:
  ros::NodeHandle nh_;
  ros::Publisher left_, right_, left_info_, right_info_;
  Listener<StereoStatus> status_;
};

/// The value of `name` in a configuration, as text.
std::string value_of(const dynamic_reconfigure::Config& config, const std::string& name);

}  // namespace fpga_stereo::test
