// Stand-ins for the transports compressed, theora and compressedDepth of image_transport_plugins,
// which Debian does not have: they take the encodings that the originals take, and log an error for
// others as the originals do. And a transport `copied` for subscribers.
#include <image_transport/simple_publisher_plugin.h>
#include <image_transport/simple_subscriber_plugin.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/image_encodings.h>
#include <std_msgs/String.h>

#include <pluginlib/class_list_macros.hpp>
#include <string>

namespace fpga_stereo::test {

class StandIn : public image_transport::SimplePublisherPlugin<std_msgs::String> {
 public:
  StandIn(std::string name, bool is_for_depth) : name_(std::move(name)), for_depth_(is_for_depth) {}

  std::string getTransportName() const override { return name_; }

 protected:
  void publish(const sensor_msgs::Image& image, const PublishFn& publish_fn) const override {
    namespace enc = sensor_msgs::image_encodings;
    const bool is_depth = image.encoding == enc::TYPE_32FC1 || image.encoding == enc::TYPE_16UC1;
    if (is_depth != for_depth_) {
      ROS_ERROR_STREAM(name_ << " cannot encode " << image.encoding);
      return;
    }
    std_msgs::String message;
    message.data = image.encoding;
    publish_fn(message);
  }

 private:
  const std::string name_;
  const bool for_depth_;
};

class Compressed : public StandIn {
 public:
  Compressed() : StandIn("compressed", false) {}
};
class Theora : public StandIn {
 public:
  Theora() : StandIn("theora", false) {}
};
class CompressedDepth : public StandIn {
 public:
  CompressedDepth() : StandIn("compressedDepth", true) {}
};

class Copied : public image_transport::SimpleSubscriberPlugin<sensor_msgs::Image> {
 public:
  std::string getTransportName() const override { return "copied"; }

 protected:
  void internalCallback(const sensor_msgs::ImageConstPtr& image,
                        const Callback& callback) override {
    callback(image);
  }
};

}  // namespace fpga_stereo::test

PLUGINLIB_EXPORT_CLASS(fpga_stereo::test::Compressed, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(fpga_stereo::test::Theora, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(fpga_stereo::test::CompressedDepth, image_transport::PublisherPlugin)
PLUGINLIB_EXPORT_CLASS(fpga_stereo::test::Copied, image_transport::SubscriberPlugin)
