// Receives raw pairs from topics: subscribes on demand, pairs by stamp, decodes.
#pragma once

#include <image_transport/subscriber_filter.h>
#include <message_filters/subscriber.h>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/thread_safety.hpp"
#include "ros/demand.hpp"
#include "ros/health.hpp"
#include "ros/settings.hpp"
#include "ros/source_pair.hpp"
#include "ros/stamp_gate.hpp"

namespace fpga_stereo {

/// Subscribes to left|right/image_raw and left|right/camera_info. All messages arrive in one
/// callback queue, one at a time. The other functions may be called from any thread, but only one
/// of them at a time. The lock is not held while a pair is decoded or handed on.
class TopicInput {
 public:
  using Callback = std::function<void(const SourcePair&)>;

  /// Hands pairs to `callback`. `health` and `gate` must outlive the input.
  TopicInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
             const SyncSettings& settings, Health& health, StampGate& gate, Callback callback);

  /// Subscribes. Does nothing if it is subscribed already.
  void start() FPGA_STEREO_EXCLUDES(mutex_);
  void stop() FPGA_STEREO_EXCLUDES(mutex_);
  /// Sets which images the next pair needs in colour.
  void set_demand(const Demand& demand) FPGA_STEREO_EXCLUDES(mutex_);
  /// Says what is missing on the topics if no pair has come for 3 s; nullopt while pairs come.
  std::optional<StateReport> trouble() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  enum Topic { kLeftImage, kLeftInfo, kRightImage, kRightInfo, kTopics };
  using Image = sensor_msgs::Image;
  using Info = sensor_msgs::CameraInfo;
  using Exact = message_filters::sync_policies::ExactTime<Image, Info, Image, Info>;
  using Approximate = message_filters::sync_policies::ApproximateTime<Image, Info, Image, Info>;

  /// The latest message of one topic since start().
  struct Arrival {
    ros::WallTime when;  // zero: none yet
    ros::Time stamp;
  };

  void on_message(Topic topic, const ros::Time& stamp) FPGA_STEREO_EXCLUDES(mutex_);
  void on_pair(const sensor_msgs::ImageConstPtr& left,
               const sensor_msgs::CameraInfoConstPtr& left_info,
               const sensor_msgs::ImageConstPtr& right,
               const sensor_msgs::CameraInfoConstPtr& right_info) FPGA_STEREO_EXCLUDES(mutex_);
  /// Notes that the left image with this stamp has found its partners. Returns the demand, or
  /// nullopt if the image is counted as dropped already.
  std::optional<Demand> note_pair(const ros::Time& stamp) FPGA_STEREO_EXCLUDES(mutex_);
  StateReport silent_topics(const std::vector<std::string>& topics, bool has_images) const;
  StateReport stamps_differ(const std::array<Arrival, kTopics>& arrivals) const;

  ros::NodeHandle nh_, private_nh_;
  const SyncSettings settings_;
  Health& health_;
  StampGate& gate_;
  const Callback callback_;

  image_transport::ImageTransport transport_;
  image_transport::SubscriberFilter left_image_, right_image_;
  message_filters::Subscriber<Info> left_info_, right_info_;
  std::unique_ptr<message_filters::Synchronizer<Exact>> exact_;
  std::unique_ptr<message_filters::Synchronizer<Approximate>> approximate_;

  mutable Mutex mutex_;
  bool is_subscribed_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  Demand demand_ FPGA_STEREO_GUARDED_BY(mutex_);
  ros::WallTime started_ FPGA_STEREO_GUARDED_BY(mutex_);
  ros::WallTime last_pair_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::array<Arrival, kTopics> arrivals_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::set<ros::Time> unpaired_ FPGA_STEREO_GUARDED_BY(mutex_);  // stamps of left images
};

}  // namespace fpga_stereo
