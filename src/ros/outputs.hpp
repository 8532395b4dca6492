// The topics that the node publishes, and who listens to them.
#pragma once

#include <image_transport/image_transport.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <functional>

#include "ros/frame.hpp"
#include "ros/image_output.hpp"
#include "ros/message_pool.hpp"

namespace fpga_stereo {

/// Publishes a frame on every topic that has a subscriber. Converts nothing nobody listens to.
class Outputs {
 public:
  /// `changed` is called when somebody begins or ceases to listen, possibly before this
  /// constructor returns.
  Outputs(const ros::NodeHandle& nh, const std::function<void()>& changed);

  /// What the next frame needs, given how the cloud is coloured.
  Demand demand(const Settings& settings) const;
  void publish(const StereoFrame& frame);

 private:
  /// The topics of one camera, named as image_proc names them.
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
  ros::Time last_cloud_;  // stamp
  MessagePool<sensor_msgs::PointCloud2> clouds_;
  MessagePool<stereo_msgs::DisparityImage> disparities_;
};

}  // namespace fpga_stereo
