// A camera pair made of publishers, and listeners that wait; shared by the tests of a running node.
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

/// Waits until `condition` holds. Returns false if it does not within `seconds`.
bool eventually(const std::function<bool()>& condition, double seconds = 10);
/// Returns true if `condition` holds throughout `seconds`.
bool always(const std::function<bool()>& condition, double seconds = 1);

/// Subscribes to a topic and keeps its messages in order.
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
  /// Waits until one of the messages fulfils `condition`.
  bool any(const std::function<bool(const Message&)>& condition) const {
    return eventually([&] {
      const std::lock_guard<std::mutex> lock(mutex_);
      return std::any_of(messages_.begin(), messages_.end(),
                         [&](const Ptr& message) { return condition(*message); });
    });
  }
  /// Returns the number of messages so far that fulfil `condition`.
  std::size_t count_if(const std::function<bool(const Message&)>& condition) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return static_cast<std::size_t>(
        std::count_if(messages_.begin(), messages_.end(),
                      [&](const Ptr& message) { return condition(*message); }));
  }
  /// Waits for the message with this stamp. Returns null if it does not arrive.
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

/// The four messages of a pair. Tests may damage them.
struct PairMessages {
  sensor_msgs::Image left, right;
  sensor_msgs::CameraInfo left_info, right_info;

  void set_stamp(const ros::Time& stamp);
};

/// Returns a textured pair with the same disparity everywhere; with lens distortion if `distorted`.
PairMessages synthetic_pair(cv::Size size, int disparity, bool distorted = false);

/// Returns the disparity that the reference pipeline computes for the pair.
cv::Mat1w core_disparity(const PairMessages& pair, const Parameters& parameters);

/// Publishes a camera pair in a namespace, in which the node under test has the name `node`.
class Rig {
 public:
  explicit Rig(const std::string& ns = "stereo", const std::string& image = "image_raw",
               const std::string& node = "fpga_stereo");

  ros::NodeHandle& nh() { return nh_; }
  /// Publishes the pair with a fresh stamp, or with its own stamps if `keep_stamps`. Returns the
  /// stamp of the left image.
  ros::Time publish(PairMessages pair, bool keep_stamps = false);
  /// Waits until the node subscribes to all four topics and sends to every listener.
  bool node_listens();
  /// How many subscribers each of the four topics has.
  struct Subscribers {
    unsigned left = 0, left_info = 0, right = 0, right_info = 0;

    bool operator==(const Subscribers& o) const {
      return left == o.left && left_info == o.left_info && right == o.right &&
             right_info == o.right_info;
    }
  };
  Subscribers subscribers() const;
  /// Waits until the node subscribes to none of the four topics.
  bool node_is_unsubscribed();
  /// Sets a parameter by name and text. Returns the parameters that the node answers with.
  dynamic_reconfigure::Config reconfigure(const std::string& name, const std::string& value);
  /// Waits for a status that fulfils `condition`. Returns the last status seen.
  StereoStatus status_when(const std::function<bool(const StereoStatus&)>& condition,
                           double seconds = 15);
  /// Waits for a status that was made after this call.
  StereoStatus status();

 private:
  ros::NodeHandle nh_;
  const std::string node_;
  ros::Publisher left_, right_, left_info_, right_info_;
  Listener<StereoStatus> status_;
};

/// Returns the value of a parameter as text.
std::string value_of(const dynamic_reconfigure::Config& config, const std::string& name);

}  // namespace fpga_stereo::test
