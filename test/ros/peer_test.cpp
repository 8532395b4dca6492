// The same recorded pairs through stereo_image_proc (the peer) and through this node. The tests
// compare every field; comments that begin with "Intended" mark the intended differences.
#include <gtest/gtest.h>
#include <image_geometry/stereo_camera_model.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>
#include <unistd.h>

#include <cmath>

#include "ros/clouds.hpp"
#include "ros/conversions.hpp"
#include "ros/rig.hpp"
#include "support/data.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::Image;
using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

/// Writes the pairs to a bag, reads them back and publishes them.
void play(Rig& rig, const std::vector<PairMessages>& frames) {
  const std::string path = "/tmp/fpga_stereo_peer_" + std::to_string(getpid()) + ".bag";
  {
    rosbag::Bag bag(path, rosbag::bagmode::Write);
    for (const PairMessages& f : frames) {
      bag.write("/stereo/left/image_raw", f.left.header.stamp, f.left);
      bag.write("/stereo/right/image_raw", f.left.header.stamp, f.right);
      bag.write("/stereo/left/camera_info", f.left.header.stamp, f.left_info);
      bag.write("/stereo/right/camera_info", f.left.header.stamp, f.right_info);
    }
  }
  rosbag::Bag bag(path);
  std::map<ros::Time, PairMessages> by_stamp;
  for (const rosbag::MessageInstance& m : rosbag::View(bag)) {
    PairMessages& pair = by_stamp[m.getTime()];
    if (m.getTopic() == "/stereo/left/image_raw") pair.left = *m.instantiate<Image>();
    if (m.getTopic() == "/stereo/right/image_raw") pair.right = *m.instantiate<Image>();
    using sensor_msgs::CameraInfo;
    if (m.getTopic() == "/stereo/left/camera_info") pair.left_info = *m.instantiate<CameraInfo>();
    if (m.getTopic() == "/stereo/right/camera_info") pair.right_info = *m.instantiate<CameraInfo>();
  }
  for (const auto& [stamp, pair] : by_stamp) {
    rig.publish(pair, true);
    ros::WallDuration(0.4).sleep();
  }
  unlink(path.c_str());
}

class Peer : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(rig_.node_listens());
    // The peer has several nodelets that subscribe one after the other.
    ASSERT_TRUE(eventually(
        [this] { return peer_disparity_.count() > 0 || (warm_up(), peer_disparity_.count() > 0); },
        20));
  }

  void warm_up() {
    rig_.publish(synthetic_pair({160, 120}, 12, true));
    ros::WallDuration(0.5).sleep();
  }

  /// Publishes one pair from a bag. Returns its stamp.
  ros::Time play_synthetic_frame() {
    PairMessages pair = synthetic_pair({160, 120}, 12, true);
    pair.set_stamp(ros::Time::now());
    play(rig_, {pair});
    return pair.left.header.stamp;
  }

  Rig rig_;
  ros::NodeHandle peer_{"peer"};
  Listener<DisparityImage> disparity_{rig_.nh(), "disparity"};
  Listener<PointCloud2> cloud_{rig_.nh(), "points2"};
  Listener<Image> rect_{rig_.nh(), "left/image_rect"};
  Listener<DisparityImage> peer_disparity_{peer_, "disparity"};
  Listener<Image> peer_rect_{peer_, "left/image_rect"};
  // The peer's cloud of this node's disparity and image.
  Listener<PointCloud2> peer_cloud_{peer_, "points2"};
};

TEST_F(Peer, DisparityFields) {
  const ros::Time stamp = play_synthetic_frame();
  const auto ours = disparity_.with_stamp(stamp);
  const auto theirs = peer_disparity_.with_stamp(stamp);
  ASSERT_TRUE(ours && theirs);

  EXPECT_EQ(ours->header.stamp, theirs->header.stamp);
  EXPECT_EQ(ours->header.frame_id, theirs->header.frame_id);
  EXPECT_EQ(ours->image.header.stamp, theirs->image.header.stamp);
  EXPECT_EQ(ours->image.header.frame_id, theirs->image.header.frame_id);
  EXPECT_EQ(ours->image.height, theirs->image.height);
  EXPECT_EQ(ours->image.width, theirs->image.width);
  EXPECT_EQ(ours->image.encoding, theirs->image.encoding);
  EXPECT_EQ(ours->image.is_bigendian, theirs->image.is_bigendian);
  EXPECT_EQ(ours->image.step, theirs->image.step);
  EXPECT_EQ(ours->image.data.size(), theirs->image.data.size());
  EXPECT_EQ(ours->f, theirs->f);
  EXPECT_EQ(ours->T, theirs->T);
  EXPECT_EQ(ours->min_disparity, theirs->min_disparity);
  EXPECT_EQ(ours->max_disparity, theirs->max_disparity);

  // Intended: the step of this node is finer.
  EXPECT_EQ(ours->delta_d, 0.03125F);
  EXPECT_EQ(theirs->delta_d, 0.0625F);
  // Intended: semi-global matching has no border of half a window.
  EXPECT_EQ(ours->valid_window.x_offset, theirs->valid_window.x_offset - 7);
  EXPECT_EQ(ours->valid_window.y_offset, theirs->valid_window.y_offset - 7);

  // Invalid pixels have the same value; valid ones agree with each other.
  for (unsigned i = 0; i < 160 * 120; ++i) {
    const float a = float_at(ours->image.data, i * 4);
    EXPECT_TRUE(a == -1 || a >= 0) << a;
  }
  expect_close_disparities(*ours, *theirs);
}

TEST_F(Peer, ValidWindowOfWindowMatching) {
  rig_.reconfigure("stereo_algorithm", "window");
  const ros::Time stamp = play_synthetic_frame();
  const auto message = disparity_.with_stamp(stamp);
  const auto peer_message = peer_disparity_.with_stamp(stamp);
  rig_.reconfigure("stereo_algorithm", "sgm");
  ASSERT_TRUE(message && peer_message);
  const auto& ours = message->valid_window;
  const auto& theirs = peer_message->valid_window;
  EXPECT_EQ(ours.x_offset, theirs.x_offset);
  EXPECT_EQ(ours.y_offset, theirs.y_offset);
  // Intended: the peer computes the window before it knows the size of the image.
  EXPECT_EQ(ours.width, 160U - 1 - 7 - 70);
  EXPECT_EQ(ours.height, 120U - 1 - 14);
  EXPECT_GT(theirs.width, 4000000000U);
}

TEST_F(Peer, RectifiedImages) {
  const ros::Time stamp = play_synthetic_frame();
  const auto ours = rect_.with_stamp(stamp);
  const auto theirs = peer_rect_.with_stamp(stamp);
  ASSERT_TRUE(ours && theirs);
  EXPECT_EQ(ours->header.frame_id, theirs->header.frame_id);
  EXPECT_EQ(ours->encoding, theirs->encoding);
  EXPECT_EQ(ours->step, theirs->step);
  ASSERT_EQ(ours->data.size(), theirs->data.size());
  double difference = 0;
  for (std::size_t i = 0; i < ours->data.size(); ++i) {
    difference += std::abs(ours->data[i] - theirs->data[i]);
  }
  EXPECT_LE(difference / static_cast<double>(ours->data.size()), 0.5);
}

TEST_F(Peer, CloudOfTheSameDisparity) {
  const ros::Time stamp = play_synthetic_frame();
  const auto ours = cloud_.with_stamp(stamp);
  const auto theirs = peer_cloud_.with_stamp(stamp);
  const auto disparity = disparity_.with_stamp(stamp);
  ASSERT_TRUE(ours && theirs && disparity);
  expect_same_cloud(*ours, *theirs, *disparity);
}

TEST_F(Peer, RealFrames) {
  if (!data_dir()) GTEST_SKIP() << kNoData;
  std::vector<PairMessages> frames;
  const CalibrationPair calibration = euroc_calibration();
  for (const int index : {0, 6}) {
    const ImagePair images = euroc_pair(index);
    PairMessages pair = synthetic_pair(images.left.size(), 12);
    std::copy_n(images.left.ptr(), pair.left.data.size(), pair.left.data.begin());
    std::copy_n(images.right.ptr(), pair.right.data.size(), pair.right.data.begin());
    const auto fill = [](const CameraCalibration& from, sensor_msgs::CameraInfo& to) {
      std::copy(from.K.begin(), from.K.end(), to.K.begin());
      std::copy(from.R.begin(), from.R.end(), to.R.begin());
      std::copy(from.P.begin(), from.P.end(), to.P.begin());
      to.D = from.D;
      to.D.resize(5);
    };
    fill(calibration.left, pair.left_info);
    fill(calibration.right, pair.right_info);
    pair.set_stamp(ros::Time::now() + ros::Duration(index));
    frames.push_back(pair);
  }
  image_geometry::StereoCameraModel model;
  ASSERT_TRUE(model.fromCameraInfo(frames[0].left_info, frames[0].right_info));
  play(rig_, frames);
  for (const PairMessages& frame : frames) {
    const ros::Time stamp = frame.left.header.stamp;
    const auto disparity = disparity_.with_stamp(stamp);
    const auto ours = cloud_.with_stamp(stamp);
    const auto theirs = peer_cloud_.with_stamp(stamp);
    ASSERT_TRUE(disparity && ours && theirs);
    EXPECT_FLOAT_EQ(disparity->T, static_cast<float>(model.baseline()));
    EXPECT_FLOAT_EQ(disparity->f, static_cast<float>(model.right().fx()));
    expect_same_cloud(*ours, *theirs, *disparity);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
