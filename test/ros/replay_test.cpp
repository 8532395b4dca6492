// replay.launch publishes every frame of a bag in the time of the recording.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/PointCloud2.h>
#include <signal.h>
#include <stereo_msgs/DisparityImage.h>
#include <sys/wait.h>
#include <unistd.h>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kFrames = 10;
const ros::Time kStart(1000, 0);

void write_bag(const std::string& path) {
  rosbag::Bag bag(path, rosbag::bagmode::Write);
  PairMessages pair = synthetic_pair({160, 120}, 12, true);
  for (int i = 0; i < kFrames; ++i) {
    const ros::Time stamp = kStart + ros::Duration(0.2 * i);
    pair.set_stamp(stamp);
    bag.write("/rig/left/image_raw", stamp, pair.left);
    bag.write("/rig/right/image_raw", stamp, pair.right);
    bag.write("/rig/left/camera_info", stamp, pair.left_info);
    bag.write("/rig/right/camera_info", stamp, pair.right_info);
  }
}

TEST(Replay, PublishesEveryFrameOfTheBag) {
  const std::string path = "/tmp/fpga_stereo_replay_" + std::to_string(getpid()) + ".bag";
  write_bag(path);
  ros::NodeHandle nh("rig");
  Listener<stereo_msgs::DisparityImage> disparity(nh, "disparity");
  Listener<sensor_msgs::PointCloud2> cloud(nh, "points2");
  const pid_t roslaunch = fork();
  if (roslaunch == 0) {
    setpgid(0, 0);
    execlp("roslaunch", "roslaunch", "fpga_stereo", "replay.launch", ("bag:=" + path).c_str(),
           "camera:=rig", nullptr);
    _exit(127);
  }
  EXPECT_TRUE(
      eventually([&] { return disparity.count() == kFrames && cloud.count() == kFrames; }, 40))
      << disparity.count() << " disparities, " << cloud.count() << " clouds";
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_TRUE(disparity.with_stamp(kStart + ros::Duration(0.2 * i), 0.1)) << i;
  }
  EXPECT_TRUE(ros::param::param("/use_sim_time", false));
  kill(roslaunch, SIGINT);
  waitpid(roslaunch, nullptr, 0);
  unlink(path.c_str());
}

}  // namespace
}  // namespace fpga_stereo::test
