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
  void start() { ASSERT_TRUE(loader_.load("/stereo/fpga_stereo", "fpga_stereo/stereo", {}, {})); }
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

TEST_F(ZeroCopy, PassesOnImagesOfOneCamera) {
  Listener<Image> raw(rig_.nh(), "right/image_raw"), mono(rig_.nh(), "right/image_mono");
  Listener<Image> color(rig_.nh(), "right/image_color");
  start();
  ros::Time stamp;
  ASSERT_TRUE(eventually([&] {
    stamp = rig_.publish(synthetic_pair(kSize, 12, true));
    return mono.with_stamp(stamp, 0.2) && color.with_stamp(stamp, 0.2);
  }));
  const ImageConstPtr from = raw.with_stamp(stamp);
  ASSERT_TRUE(from);
  EXPECT_EQ(from, mono.with_stamp(stamp));
  EXPECT_EQ(from, color.with_stamp(stamp));
}

TEST_F(ZeroCopy, PublishesOneDepthImageOnBothTopics) {
  Listener<Image> depth(rig_.nh(), "depth"), rect(rig_.nh(), "depth/image_rect");
  start();
  ASSERT_TRUE(rig_.node_listens());
  const ros::Time stamp = rig_.publish(synthetic_pair(kSize, 12, true));
  const ImageConstPtr first = depth.with_stamp(stamp);
  ASSERT_TRUE(first);
  EXPECT_EQ(first, rect.with_stamp(stamp));
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
