// Raw image pairs from topics: subscribed on demand, paired by stamp.
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
#include <mutex>
#include <set>
#include <string>

#include "ros/health.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo {

/// One image pair with the calibration that belongs to it.
struct InputPair {
  sensor_msgs::ImageConstPtr left, right;
  sensor_msgs::CameraInfoConstPtr left_info, right_info;
};

/// Subscribes left|right/image_raw and left|right/camera_info. Runs in one callback queue.
class TopicInput {
 public:
  using Callback = std::function<void(const InputPair&)>;

  TopicInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
             const SyncSettings& settings, Health& health, Callback callback);

  void start();
  void stop();
  /// What is missing on the topics, in words; empty where pairs arrive.
  std::string complaint() const;

 private:
  enum Topic { kLeftImage, kLeftInfo, kRightImage, kRightInfo, kTopics };
  using Image = sensor_msgs::Image;
  using Info = sensor_msgs::CameraInfo;
  using Exact = message_filters::sync_policies::ExactTime<Image, Info, Image, Info>;
  using Approximate = message_filters::sync_policies::ApproximateTime<Image, Info, Image, Info>;

  /// What arrived on one topic since start().
  struct Arrival {
    ros::WallTime when;  // zero: nothing yet
    ros::Time stamp;
  };

  void arrived(Topic topic, const ros::Time& stamp);
  void paired(const sensor_msgs::ImageConstPtr& left,
              const sensor_msgs::CameraInfoConstPtr& left_info,
              const sensor_msgs::ImageConstPtr& right,
              const sensor_msgs::CameraInfoConstPtr& right_info);

  ros::NodeHandle nh_, private_nh_;
  SyncSettings settings_;
  Health& health_;
  Callback callback_;

  image_transport::ImageTransport transport_;
  image_transport::SubscriberFilter left_image_, right_image_;
  message_filters::Subscriber<Info> left_info_, right_info_;
  std::unique_ptr<message_filters::Synchronizer<Exact>> exact_;
  std::unique_ptr<message_filters::Synchronizer<Approximate>> approximate_;

  mutable std::mutex mutex_;  // of what complaint() reads
  bool active_ = false;
  ros::WallTime started_, last_pair_;
  std::array<Arrival, kTopics> arrivals_;
  std::set<ros::Time> waiting_;  // stamps of left images that have no pair yet
};

}  // namespace fpga_stereo
