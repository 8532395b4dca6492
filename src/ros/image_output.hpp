// One image topic.
#pragma once

#include <image_transport/image_transport.h>

#include <functional>
#include <opencv2/core.hpp>

#include "ros/message_pool.hpp"

namespace fpga_stereo {

/// Publishes images. Passes a camera's message on if possible; otherwise copies into a message that
/// no subscriber holds any more. One thread at a time.
class ImageOutput {
 public:
  ImageOutput() = default;
  explicit ImageOutput(const image_transport::Publisher& publisher) : publisher_(publisher) {}

  bool has_subscribers() const { return publisher_.getNumSubscribers() > 0; }
  /// Publishes an image of this size and type (8UC1, 8UC3, 16UC1, 32FC1) whose pixels `write`
  /// fills.
  void publish(const std_msgs::Header& header, cv::Size size, int type,
               const std::function<void(cv::Mat&)>& write);
  /// Publishes a copy of the image; or `message` itself if it has these pixels and this header.
  void publish(const std_msgs::Header& header, const cv::Mat& image,
               const sensor_msgs::ImageConstPtr& message = nullptr);

 private:
  image_transport::Publisher publisher_;
  MessagePool<sensor_msgs::Image> messages_;
};

}  // namespace fpga_stereo
