// approximate_sync pairs images whose stamps differ by no more than the tolerance.
#include <gtest/gtest.h>
#include <message_filters/subscriber.h>
#include <message_filters/time_synchronizer.h>
#include <stereo_msgs/DisparityImage.h>

#include <atomic>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kFrames = 15;

/// Publishes pairs every `period` s with the right image `offset` s later. Returns the left stamps.
std::vector<ros::Time> publish(Rig& rig, double period, double offset) {
  std::vector<ros::Time> stamps;
  PairMessages pair = synthetic_pair({160, 120}, 12);
  const ros::Time start = ros::Time::now();
  for (int i = 0; i < kFrames; ++i) {
    stamps.push_back(start + ros::Duration(period * i));
    pair.set_stamp(stamps.back());
    pair.right.header.stamp += ros::Duration(offset);
    pair.right_info.header.stamp += ros::Duration(offset);
    rig.publish(pair, true);
    ros::WallDuration(period).sleep();
  }
  return stamps;
}

TEST(Approximate, WhatIsMadeOfAPairHasTheStampOfTheLeftImage) {
  Rig rig;
  Listener<stereo_msgs::DisparityImage> disparity(rig.nh(), "disparity");
  Listener<sensor_msgs::Image> left(rig.nh(), "left/image_rect"), depth(rig.nh(), "depth");
  ASSERT_TRUE(rig.node_listens());
  const auto stamps = publish(rig, 0.2, 0.01);
  // The synchronizer decides when the next messages arrive, so the last pairs stay in its queue.
  for (int i = 0; i < kFrames - 2; ++i) {
    EXPECT_TRUE(disparity.with_stamp(stamps[i])) << i;
    EXPECT_TRUE(left.with_stamp(stamps[i])) << i;
    EXPECT_TRUE(depth.with_stamp(stamps[i])) << i;
  }
}

TEST(Approximate, ExactSubscribersFindTheCameraInfoOfTheRightImage) {
  Rig rig;
  using sensor_msgs::CameraInfo;
  using sensor_msgs::Image;
  message_filters::Subscriber<Image> image(rig.nh(), "right/image_rect", 100);
  message_filters::Subscriber<CameraInfo> info(rig.nh(), "right/camera_info", 100);
  message_filters::TimeSynchronizer<Image, CameraInfo> sync(image, info, 100);
  Listener<Image> all(rig.nh(), "right/image_rect");
  std::atomic<std::size_t> matches{0};
  const boost::function<void()> count = [&] { ++matches; };
  sync.registerCallback(boost::bind(count));
  ASSERT_TRUE(rig.node_listens());
  publish(rig, 0.2, 0.01);
  EXPECT_TRUE(eventually([&] { return all.count() >= kFrames - 2; }));
  EXPECT_TRUE(eventually([&] { return matches == all.count(); }))
      << matches << " of " << all.count();
}

TEST(Approximate, ImagesBeyondTheToleranceAreNotPaired) {
  Rig rig;
  Listener<stereo_msgs::DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const StereoStatus before = rig.status();
  publish(rig, 0.5, 0.2);
  const StereoStatus after = rig.status();
  EXPECT_EQ(disparity.count(), 0U);
  EXPECT_EQ(after.frames_published, before.frames_published);
  EXPECT_GT(after.dropped_unsynchronized, before.dropped_unsynchronized);
  EXPECT_EQ(after.state, StereoStatus::UNSYNCHRONISED);
  EXPECT_NE(after.state_text.find("sync_tolerance is 0.1"), std::string::npos) << after.state_text;
}

}  // namespace
}  // namespace fpga_stereo::test
