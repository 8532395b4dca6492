// Cameras, node and subscribers in one process, as in one nodelet manager: images that can be
// passed on are not copied.
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <stereo_msgs/DisparityImage.h>

#include <atomic>
#include <set>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::Image;
using sensor_msgs::ImageConstPtr;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

class ZeroCopy : public testing::Test {
 protected:
  void start(bool approximate_sync = false) {
    ros::param::set("/stereo/fpga_stereo/approximate_sync", approximate_sync);
    ASSERT_TRUE(loader_.load("/stereo/fpga_stereo", "fpga_stereo/stereo", {}, {}));
  }
  void TearDown() override { loader_.unload("/stereo/fpga_stereo"); }

  Rig rig_;
  nodelet::Loader loader_{false};
};

TEST_F(ZeroCopy, PassesOnTheMessageOfAGreyCamera) {
  Listener<Image> raw(rig_.nh(), "left/image_raw"), mono(rig_.nh(), "left/image_mono");
  Listener<Image> right_raw(rig_.nh(), "right/image_raw"), color(rig_.nh(), "right/image_color");
  Listener<Image> rect(rig_.nh(), "left/image_rect");
  start();
  ASSERT_TRUE(rig_.node_listens());
  const ros::Time stamp = rig_.publish(synthetic_pair(kSize, 12, true));
  const ImageConstPtr from = raw.with_stamp(stamp), to = mono.with_stamp(stamp);
  ASSERT_TRUE(from && to);
  EXPECT_EQ(from, to);
  const ImageConstPtr right_from = right_raw.with_stamp(stamp), right_to = color.with_stamp(stamp);
  ASSERT_TRUE(right_from && right_to);
  EXPECT_EQ(right_from, right_to);
  const ImageConstPtr rectified = rect.with_stamp(stamp);
  ASSERT_TRUE(rectified);
  EXPECT_NE(rectified, from);
}

// A pair has the stamp of its left image, so a right image with another stamp needs a new message.
TEST_F(ZeroCopy, CopiesAnImageThatNeedsAnotherStamp) {
  Listener<Image> raw(rig_.nh(), "right/image_raw"), mono(rig_.nh(), "right/image_mono");
  start(true /* approximate_sync */);
  ASSERT_TRUE(rig_.node_listens());
  PairMessages pair = synthetic_pair(kSize, 12, true);
  const ros::Time start_time = ros::Time::now();
  const ros::Duration later(0.001);
  for (int i = 0; i < 4; ++i) {  // the synchronizer decides when the next messages arrive
    pair.set_stamp(start_time + ros::Duration(0.1 * i));
    pair.right.header.stamp += later;
    pair.right_info.header.stamp += later;
    rig_.publish(pair, true);
    ros::WallDuration(0.1).sleep();
  }
  const ImageConstPtr from = raw.with_stamp(start_time + later);
  const ImageConstPtr to = mono.with_stamp(start_time);
  ASSERT_TRUE(from && to);
  EXPECT_EQ(from->data, to->data);
}

TEST_F(ZeroCopy, ReusesMessagesThatNoSubscriberHolds) {
  std::set<const void*> disparities, images;
  std::atomic<int> messages{0};
  const ros::Subscriber disparity =
      rig_.nh().subscribe<DisparityImage>("disparity", 1, [&](const DisparityImage::ConstPtr& m) {
        disparities.insert(m.get());
        ++messages;
      });
  const ros::Subscriber image = rig_.nh().subscribe<Image>("depth", 1, [&](const ImageConstPtr& m) {
    images.insert(m.get());
    ++messages;
  });
  start();
  ASSERT_TRUE(rig_.node_listens());
  for (int i = 1; i <= 20; ++i) {
    rig_.publish(synthetic_pair(kSize, 12));
    ASSERT_TRUE(eventually([&] { return messages >= 2 * i; }));
  }
  EXPECT_LE(disparities.size(), 4U);
  EXPECT_LE(images.size(), 4U);
}

}  // namespace
}  // namespace fpga_stereo::test
