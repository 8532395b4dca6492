#include "ros/image_output.hpp"

#include <algorithm>

#include "ros/conversions.hpp"

namespace fpga_stereo {

ImageAdvertiser::ImageAdvertiser(const ros::NodeHandle& nh, std::function<void()> changed)
    : nh_(nh), transport_(nh), changed_(std::move(changed)) {
  nh_.getParamNames(parameters_);
}

image_transport::Publisher ImageAdvertiser::advertise(const std::string& topic, ImageKind kind) {
  const std::vector<std::string> unsuitable =
      kind == ImageKind::kDepth
          ? std::vector<std::string>{"image_transport/compressed", "image_transport/theora"}
          : std::vector<std::string>{"image_transport/compressedDepth"};
  // image_transport looks for the parameter beside the topic.
  const std::string disabled = nh_.resolveName(topic) + "/disable_pub_plugins";
  const bool is_set =
      std::find(parameters_.begin(), parameters_.end(), disabled) != parameters_.end();
  if (!is_set) nh_.setParam(disabled, unsuitable);
  const image_transport::SubscriberStatusCallback on_change = [changed = changed_](const auto&) {
    changed();
  };
  return transport_.advertise(topic, 1, on_change, on_change);
}

bool ImageOutput::has_subscribers() const {
  return std::any_of(publishers_.begin(), publishers_.end(),
                     [](const auto& publisher) { return publisher.getNumSubscribers() > 0; });
}

void ImageOutput::publish(const sensor_msgs::ImageConstPtr& message) const {
  for (const auto& publisher : publishers_) {
    if (publisher.getNumSubscribers() > 0) publisher.publish(message);
  }
}

void ImageOutput::publish(const std_msgs::Header& header, cv::Size size, int type,
                          const std::function<void(cv::Mat&)>& write) {
  const auto message = messages_.take();
  cv::Mat image = image_in(*message, header, size, type);
  write(image);
  publish(message);
}

void ImageOutput::publish(const std_msgs::Header& header, const cv::Mat& image,
                          const sensor_msgs::ImageConstPtr& message) {
  if (message != nullptr && image.data == message->data.data()) {
    publish(message);
  } else {
    publish(header, image.size(), image.type(), [&](cv::Mat& to) { image.copyTo(to); });
  }
}

}  // namespace fpga_stereo
