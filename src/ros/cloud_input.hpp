// Receives what a cloud is made of: a disparity image, the left rectified image, both camera_infos.
#pragma once

#include <image_transport/subscriber_filter.h>
#include <message_filters/pass_through.h>
#include <message_filters/subscriber.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <stereo_msgs/DisparityImage.h>

#include <functional>
#include <optional>

#include "ros/arrival_log.hpp"
#include "ros/health.hpp"
#include "ros/message_sync.hpp"
#include "ros/settings.hpp"
#include "ros/stamp_gate.hpp"

namespace fpga_stereo {

struct CloudMessages {
  stereo_msgs::DisparityImageConstPtr disparity;
  sensor_msgs::ImageConstPtr color;
  sensor_msgs::CameraInfoConstPtr left_info, right_info;
};

/// Subscribes to disparity, left/image_rect_color and left|right/camera_info, the inputs of
/// stereo_image_proc/point_cloud2. All messages arrive in one callback queue, one at a time.
class CloudInput {
 public:
  using Callback = std::function<void(const CloudMessages&)>;

  /// `health` and `gate` must outlive the input, which restarts the gate if time moves back.
  CloudInput(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
             const SyncSettings& settings, Health& health, StampGate& gate, Callback callback);
  ~CloudInput() { set_subscribed(false); }
  CloudInput(const CloudInput&) = delete;
  CloudInput& operator=(const CloudInput&) = delete;

  /// One thread at a time.
  void set_subscribed(bool is_subscribed);
  /// Says what is missing on the topics; nullopt while sets of messages arrive. Any thread.
  std::optional<StateReport> trouble() const { return log_.trouble(); }

 private:
  using Image = sensor_msgs::Image;
  using Info = sensor_msgs::CameraInfo;
  using Disparity = stereo_msgs::DisparityImage;

  void on_disparity(const ros::MessageEvent<const Disparity>& event);

  ros::NodeHandle nh_, private_nh_;
  StampGate& gate_;
  const Callback callback_;
  ArrivalLog log_;
  bool is_subscribed_ = false;

  image_transport::ImageTransport transport_;
  message_filters::Subscriber<Disparity> disparity_;
  image_transport::SubscriberFilter color_;
  message_filters::Subscriber<Info> left_info_, right_info_;
  message_filters::PassThrough<Disparity> disparity_of_set_;
  std::optional<MessageSync<Disparity, Image, Info, Info>> sync_;
};

}  // namespace fpga_stereo
