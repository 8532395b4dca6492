// The topics that the node publishes and the demand of their subscribers.
#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <functional>

#include "ros/demand.hpp"
#include "ros/image_output.hpp"
#include "ros/message_pool.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// Publishes a frame on every topic that has a subscriber and makes no other conversions.
class Outputs {
 public:
  /// `changed` is called from ROS callbacks when a subscriber comes or goes, possibly before this
  /// constructor returns.
  Outputs(const ros::NodeHandle& nh, const std::function<void()>& changed);

  /// Returns what the next frame needs; the settings tell how the cloud is coloured. Any thread.
  Demand demand(const Settings& settings) const;
  /// Publishes one frame. One thread at a time.
  void publish(const StereoFrame& frame);

 private:
  /// The topics of one camera under the names of image_proc.
  struct CameraOutputs {
    ImageOutput mono, color, rect, rect_color;

    CameraDemand demand() const;
    void publish(const CameraImages& images);
  };

  void publish_depth(const StereoFrame& frame);
  void publish_cloud(const StereoFrame& frame);

  image_transport::ImageTransport transport_;
  CameraOutputs left_, right_;
  ImageOutput depth_, disparity_color_;
  ros::Publisher depth_info_, disparity_, points2_;
  ros::Time last_cloud_;  // stamp of the last published cloud
  MessagePool<sensor_msgs::PointCloud2> clouds_;
  MessagePool<stereo_msgs::DisparityImage> disparities_;
};

}  // namespace fpga_stereo
