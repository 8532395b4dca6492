#include "ros/image_output.hpp"

#include "ros/conversions.hpp"

namespace fpga_stereo {

void ImageOutput::publish(const std_msgs::Header& header, cv::Size size, int type,
                          const std::function<void(cv::Mat&)>& write) {
  const auto message = messages_.take();
  cv::Mat image = image_in(*message, header, size, type);
  write(image);
  publisher_.publish(message);
}

void ImageOutput::publish(const std_msgs::Header& header, const cv::Mat& image,
                          const sensor_msgs::ImageConstPtr& message) {
  const bool is_same = message != nullptr && image.data == message->data.data() &&
                       message->header.stamp == header.stamp &&
                       message->header.frame_id == header.frame_id;
  if (is_same) {
    publisher_.publish(message);
  } else {
    publish(header, image.size(), image.type(), [&](cv::Mat& to) { image.copyTo(to); });
  }
}

}  // namespace fpga_stereo
