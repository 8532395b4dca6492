#include "ros/image_subscription.hpp"

#include <image_transport/exception.h>

namespace fpga_stereo {

void subscribe_to_images(image_transport::ImageTransport& transport, const ros::NodeHandle& nh,
                         const ros::NodeHandle& private_nh, const std::string& name,
                         image_transport::SubscriberFilter& subscriber) {
  // A transport appends its name to the topic, which a remapping of the topic would then miss.
  const std::string topic = nh.resolveName(name);
  const ros::TransportHints ros_hints;
  const image_transport::TransportHints hints("raw", ros_hints, private_nh);
  try {
    subscriber.subscribe(transport, topic, 1, hints);
  } catch (const image_transport::TransportLoadException& e) {
    ROS_ERROR_STREAM_NAMED("stereo", "image_transport = " << hints.getTransport()
                                                          << ": the plugin cannot be loaded; "
                                                             "using raw for "
                                                          << topic << ": " << e.what());
    // Nobody sets this private parameter, so the default holds.
    subscriber.subscribe(transport, topic, 1,
                         {"raw", ros_hints, private_nh, "image_transport_of_fallback"});
  }
}

}  // namespace fpga_stereo
