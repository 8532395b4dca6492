// Subscribes to images with a transport that can be loaded.
#pragma once

#include <image_transport/subscriber_filter.h>
#include <ros/ros.h>

#include <string>

namespace fpga_stereo {

/// Subscribes to `name`, relative to `nh`, with a queue of 1 and the transport of the parameter
/// image_transport, or raw, with an error message, if its plugin cannot be loaded.
void subscribe_to_images(image_transport::ImageTransport& transport, const ros::NodeHandle& nh,
                         const ros::NodeHandle& private_nh, const std::string& name,
                         image_transport::SubscriberFilter& subscriber);

}  // namespace fpga_stereo
