// A topic of images.
#pragma once

#include <image_transport/image_transport.h>

#include <functional>
#include <opencv2/core.hpp>

#include "ros/message_pool.hpp"

namespace fpga_stereo {

/// Publishes images without a copy where there is a message already, and else into the memory of
/// messages that nobody holds any more.
class ImageOutput {
 public:
  ImageOutput() = default;
  explicit ImageOutput(const image_transport::Publisher& publisher) : publisher_(publisher) {}

  bool wanted() const { return publisher_.getNumSubscribers() > 0; }
  /// The image of this size and type (8UC1, 8UC3, 16UC1, 32FC1) that `write` makes.
  void publish(const std_msgs::Header& header, cv::Size size, int type,
               const std::function<void(cv::Mat&)>& write);
  /// This image; `raw` itself, where that has these pixels and this header.
  void publish(const std_msgs::Header& header, const cv::Mat& image,
               const sensor_msgs::ImageConstPtr& raw = nullptr);

 private:
  image_transport::Publisher publisher_;
  MessagePool<sensor_msgs::Image> messages_;
};

}  // namespace fpga_stereo
