// A pair in the namespace of the launch file under test leads to a disparity and a cloud.
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

TEST(Launch, PublishesDisparityAndCloud) {
  ros::NodeHandle nh("rig");
  Listener<stereo_msgs::DisparityImage> disparity(nh, "disparity");
  Listener<sensor_msgs::PointCloud2> cloud(nh, "points2");
  const auto advertise = [&](auto message, const std::string& topic) {
    return nh.advertise<decltype(message)>(topic, 10);
  };
  const std::string left = ros::param::param<std::string>("/left", "left");
  ros::Publisher left_image = advertise(sensor_msgs::Image(), left + "/image_raw");
  ros::Publisher left_info = advertise(sensor_msgs::CameraInfo(), left + "/camera_info");
  ros::Publisher right_image = advertise(sensor_msgs::Image(), "right/image_raw");
  ros::Publisher right_info = advertise(sensor_msgs::CameraInfo(), "right/camera_info");
  PairMessages pair = synthetic_pair({160, 120}, 12, true);
  EXPECT_TRUE(eventually(
      [&] {
        pair.set_stamp(ros::Time::now());
        left_info.publish(pair.left_info);
        right_info.publish(pair.right_info);
        left_image.publish(pair.left);
        right_image.publish(pair.right);
        ros::WallDuration(0.2).sleep();
        return disparity.count() > 2 && cloud.count() > 2;
      },
      30));
  // The parameters have the documented names.
  const std::string node = ros::param::param<std::string>("/node", "fpga_stereo");
  EXPECT_TRUE(nh.hasParam(node + "/disparity_range"));
  EXPECT_TRUE(nh.hasParam(node + "/approximate_sync"));
}

}  // namespace
}  // namespace fpga_stereo::test
