#include "ros/cloud_output.hpp"

namespace fpga_stereo {

CloudOutput::CloudOutput(ros::NodeHandle nh, const std::function<void()>& changed) {
  const ros::SubscriberStatusCallback on_change = [changed](const auto&) { changed(); };
  publisher_ = nh.advertise<sensor_msgs::PointCloud2>("points2", 1, on_change, on_change);
}

void CloudOutput::publish(const ros::Time& stamp, const Settings& settings,
                          const std::function<void(sensor_msgs::PointCloud2&)>& write) {
  if (!has_subscribers()) return;
  const double elapsed = (stamp - last_).toSec();
  // Stamps jitter, so a tenth of a period early is in time. Time that went back is not early.
  const bool is_early = elapsed >= 0 && elapsed * settings.cloud_max_rate < 0.9;
  if (settings.cloud_max_rate > 0 && is_early) return;
  last_ = stamp;
  const auto message = messages_.take();
  write(*message);
  publisher_.publish(message);
}

}  // namespace fpga_stereo
