// The topic points2.
#pragma once

#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <functional>

#include "ros/message_pool.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo {

/// Publishes clouds no more often than the settings allow. One thread at a time.
class CloudOutput {
 public:
  CloudOutput() = default;
  /// `changed` is called when a subscriber comes or goes.
  CloudOutput(ros::NodeHandle nh, const std::function<void()>& changed);

  bool has_subscribers() const { return publisher_.getNumSubscribers() > 0; }
  /// Publishes a cloud with this stamp that `write` fills; does nothing if nobody subscribes, or if
  /// the previous cloud is too recent.
  void publish(const ros::Time& stamp, const Settings& settings,
               const std::function<void(sensor_msgs::PointCloud2&)>& write);

 private:
  ros::Publisher publisher_;
  ros::Time last_;  // stamp of the last published cloud
  MessagePool<sensor_msgs::PointCloud2> messages_;
};

}  // namespace fpga_stereo
