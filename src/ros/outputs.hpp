// The topics that the node publishes and the demand of their subscribers.
#pragma once

#include <ros/ros.h>
#include <stereo_msgs/DisparityImage.h>

#include <functional>

#include "ros/cloud_output.hpp"
#include "ros/demand.hpp"
#include "ros/image_output.hpp"
#include "ros/message_pool.hpp"
#include "ros/raw_outputs.hpp"
#include "ros/settings.hpp"
#include "ros/source_pair.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// Publishes a frame on every topic that has a subscriber and makes no other conversions.
class Outputs {
 public:
  /// `changed` is called from ROS callbacks when a subscriber comes or goes, possibly before this
  /// constructor returns.
  Outputs(const ros::NodeHandle& nh, const OutputTopics& topics,
          const std::function<void()>& changed);

  /// Returns what the next frame needs; the settings tell how the cloud is coloured. Any thread.
  Demand demand(const Settings& settings) const;
  /// Publishes one frame. One thread at a time.
  void publish(const StereoFrame& frame);
  /// Passes an image of one camera on. Refuses an image that cannot be decoded. Any thread.
  Status publish_image(Side side, const sensor_msgs::ImageConstPtr& message);
  /// Passes the images of a board's cameras on, those that the pair has. Any thread.
  void publish_images(const SourcePair& pair);

 private:
  /// The rectified images of one camera under the names of image_proc.
  struct RectifiedOutputs {
    ImageOutput rect, rect_color;

    void add_demand(CameraDemand& demand) const;
    void publish(const CameraImages& images);
  };

  void advertise_images(ImageAdvertiser& advertiser);
  void publish_depth(const StereoFrame& frame);
  void publish_cloud(const StereoFrame& frame);

  RawOutputs left_raw_, right_raw_;
  RectifiedOutputs left_, right_;
  ImageOutput depth_, disparity_color_;
  ros::Publisher depth_info_, disparity_;
  CloudOutput points2_;
  MessagePool<stereo_msgs::DisparityImage> disparities_;
};

}  // namespace fpga_stereo
