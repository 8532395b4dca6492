// Image topics.
#pragma once

#include <image_transport/image_transport.h>

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <utility>
#include <vector>

#include "ros/message_pool.hpp"

namespace fpga_stereo {

enum class ImageKind {
  kEightBit,  // mono8 or bgr8
  kDepth,     // 32FC1 or 16UC1
};

/// Advertises image topics with the transports that can encode such images: others would log an
/// error for every image (rosbag record -a subscribes to all of them).
class ImageAdvertiser {
 public:
  /// `changed` is called from ROS callbacks when a subscriber comes or goes.
  ImageAdvertiser(const ros::NodeHandle& nh, std::function<void()> changed);

  /// Sets the topic's parameter disable_pub_plugins unless it is set already.
  image_transport::Publisher advertise(const std::string& topic, ImageKind kind);

 private:
  ros::NodeHandle nh_;
  image_transport::ImageTransport transport_;
  std::function<void()> changed_;
  std::vector<std::string> parameters_;  // of the parameter server: asked once, not per topic
};

/// Publishes the same images on one or more topics. Passes a camera's message on if possible;
/// otherwise copies into a message that no subscriber holds any more. One thread at a time.
class ImageOutput {
 public:
  ImageOutput() = default;
  explicit ImageOutput(image_transport::Publisher publisher) : publishers_{std::move(publisher)} {}
  explicit ImageOutput(std::vector<image_transport::Publisher> publishers)
      : publishers_(std::move(publishers)) {}

  bool has_subscribers() const;
  /// Publishes an image of this size and type (8UC1, 8UC3, 16UC1, 32FC1) whose pixels `write`
  /// fills.
  void publish(const std_msgs::Header& header, cv::Size size, int type,
               const std::function<void(cv::Mat&)>& write);
  /// Publishes a copy of the image; or `message` itself if it has these pixels.
  void publish(const std_msgs::Header& header, const cv::Mat& image,
               const sensor_msgs::ImageConstPtr& message = nullptr);

 private:
  void publish(const sensor_msgs::ImageConstPtr& message) const;

  std::vector<image_transport::Publisher> publishers_;  // empty: not advertised
  MessagePool<sensor_msgs::Image> messages_;
};

}  // namespace fpga_stereo
