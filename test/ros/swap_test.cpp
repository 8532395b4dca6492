// Nodelets of stereo_image_proc, loaded by hand, and the nodelets of the same names of this
// package, on the pairs that image_proc rectifies; and fpga_stereo/stereo beside image_proc.
#include <cv_bridge/cv_bridge.h>
#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <cmath>
#include <memory>
#include <set>

#include "ros/clouds.hpp"
#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::Image;
using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

/// Returns a pair of a colour camera.
PairMessages color_pair(bool distorted) {
  PairMessages pair = synthetic_pair(kSize, 12, distorted);
  for (Image* image : {&pair.left, &pair.right}) {
    const auto header = image->header;
    const cv::Mat texture = cv_bridge::toCvCopy(*image)->image;
    cv::Mat color;
    cv::merge(std::vector<cv::Mat>{texture, texture / 2, 255 - texture}, color);
    *image = *cv_bridge::CvImage(header, "bgr8", color).toImageMsg();
  }
  return pair;
}

class Swap : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(rig_.node_listens());
    // There are many nodelets, which subscribe one after the other.
    ASSERT_TRUE(eventually(
        [this] {
          rig_.publish(color_pair(false));
          ros::WallDuration(0.5).sleep();
          return disparity_.count() > 0 && peer_disparity_.count() > 0 && cloud_.count() > 0 &&
                 peer_cloud_.count() > 0 && whole_disparity_.count() > 0 &&
                 whole_cloud_.count() > 0 && cloud_of_whole_.count() > 0 &&
                 cloud_of_peer_.count() > 0 && depth_cloud_.count() > 0;
        },
        60));
  }

  Rig rig_;
  ros::NodeHandle ours_{"ours"}, peer_{"peer"}, whole_{"whole"}, mixed_{"mixed"};
  Listener<DisparityImage> disparity_{ours_, "disparity"}, peer_disparity_{peer_, "disparity"};
  Listener<PointCloud2> cloud_{ours_, "points2"}, peer_cloud_{peer_, "points2"};
  // Of fpga_stereo/stereo, and the cloud that fpga_stereo/point_cloud2 makes of its disparity.
  Listener<DisparityImage> whole_disparity_{rig_.nh(), "disparity"};
  Listener<PointCloud2> whole_cloud_{rig_.nh(), "points2"};
  Listener<PointCloud2> cloud_of_whole_{whole_, "points2"};
  // The cloud that fpga_stereo/point_cloud2 makes of stereo_image_proc's disparity.
  Listener<PointCloud2> cloud_of_peer_{mixed_, "points2"};
  // The cloud that depth_image_proc makes of our depth.
  Listener<PointCloud2> depth_cloud_{rig_.nh(), "depth/points"};
};

TEST_F(Swap, HasTheTopicsOfThePeer) {
  const auto ours = types_by_topic("/ours/"), theirs = types_by_topic("/peer/");
  EXPECT_EQ(theirs.count("disparity"), 1U);
  EXPECT_EQ(theirs.count("points2"), 1U);
  for (const auto& [topic, type] : theirs) {
    ASSERT_EQ(ours.count(topic), 1U) << topic;
    EXPECT_EQ(ours.at(topic), type) << topic;
  }
  std::set<std::string> additional;
  for (const auto& [topic, type] : ours) {
    if (theirs.count(topic) == 0) additional.insert(topic);
  }
  EXPECT_EQ(additional, (std::set<std::string>{"disparity/status", "point_cloud2/status"}));
}

TEST_F(Swap, HasTheParametersOfThePeer) {
  const auto names = [](const std::string& node) {
    XmlRpc::XmlRpcValue values;
    ros::param::get(node, values);
    std::set<std::string> found;
    for (const auto& [name, value] : values) found.insert(name);
    return found;
  };
  const std::set<std::string> ours = names("/ours/disparity");
  // Intended: these have no counterpart. stereo_algorithm is left unset unless the user sets it.
  const std::set<std::string> missing{"P1",
                                      "P2",
                                      "fullDP",
                                      "prefilter_cap",
                                      "prefilter_size",
                                      "stereo_algorithm",
                                      "texture_threshold"};
  const std::set<std::string> theirs = names("/peer/disparity");
  EXPECT_EQ(theirs.count("disparity_range"), 1U);
  for (const std::string& name : theirs) {
    EXPECT_EQ(ours.count(name) + missing.count(name), 1U) << name;
  }
}

TEST_F(Swap, DisparityHasTheFieldsOfThePeer) {
  const ros::Time stamp = rig_.publish(color_pair(true));
  const auto ours = disparity_.with_stamp(stamp), theirs = peer_disparity_.with_stamp(stamp);
  ASSERT_TRUE(ours && theirs);
  EXPECT_EQ(ours->header.frame_id, theirs->header.frame_id);
  EXPECT_EQ(ours->image.header.stamp, theirs->image.header.stamp);
  EXPECT_EQ(ours->image.header.frame_id, theirs->image.header.frame_id);
  EXPECT_EQ(ours->image.width, theirs->image.width);
  EXPECT_EQ(ours->image.height, theirs->image.height);
  EXPECT_EQ(ours->image.encoding, theirs->image.encoding);
  EXPECT_EQ(ours->image.step, theirs->image.step);
  EXPECT_EQ(ours->f, theirs->f);
  EXPECT_EQ(ours->T, theirs->T);
  EXPECT_EQ(ours->min_disparity, theirs->min_disparity);
  EXPECT_EQ(ours->max_disparity, theirs->max_disparity);
  expect_close_disparities(*ours, *theirs);
}

// K, D and R of the camera_info describe the raw image; the rectified one must not move again.
TEST_F(Swap, DisparityIsThatOfTheRectifiedImages) {
  Listener<Image> left(rig_.nh(), "left/image_rect"), right(rig_.nh(), "right/image_rect");
  ASSERT_TRUE(eventually(all_links_are_up));
  PairMessages pair = synthetic_pair(kSize, 12, true);
  const ros::Time stamp = rig_.publish(pair);
  const auto message = disparity_.with_stamp(stamp);
  const auto left_rect = left.with_stamp(stamp), right_rect = right.with_stamp(stamp);
  ASSERT_TRUE(message && left_rect && right_rect);
  pair.left = *left_rect;
  pair.right = *right_rect;
  for (auto* info : {&pair.left_info, &pair.right_info}) info->D.assign(5, 0);
  expect_disparity(*message, core_disparity(pair, Parameters()), 0);
}

TEST_F(Swap, CloudOfThePeersDisparityEqualsThePeers) {
  const ros::Time stamp = rig_.publish(color_pair(true));
  const auto disparity = peer_disparity_.with_stamp(stamp);
  const auto ours = cloud_of_peer_.with_stamp(stamp), theirs = peer_cloud_.with_stamp(stamp);
  ASSERT_TRUE(disparity && ours && theirs);
  expect_same_cloud(*ours, *theirs, *disparity);
}

// Undistorted, so that the images of image_proc and of fpga_stereo/stereo are the same.
TEST_F(Swap, NodeletsInARowGiveTheBytesOfTheStereoNodelet) {
  const ros::Time stamp = rig_.publish(color_pair(false));
  const auto disparity = disparity_.with_stamp(stamp);
  const auto whole_disparity = whole_disparity_.with_stamp(stamp);
  ASSERT_TRUE(disparity && whole_disparity);
  EXPECT_EQ(disparity->image.data, whole_disparity->image.data);
  const auto expected = whole_cloud_.with_stamp(stamp);
  ASSERT_TRUE(expected);
  for (const auto& cloud : {cloud_.with_stamp(stamp), cloud_of_whole_.with_stamp(stamp)}) {
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->header.frame_id, expected->header.frame_id);
    EXPECT_EQ(cloud->width, expected->width);
    EXPECT_EQ(cloud->height, expected->height);
    expect_same_fields(*cloud, *expected);
    EXPECT_EQ(cloud->data, expected->data);
  }
}

TEST_F(Swap, EveryImageHasOnePublisherBesideImageProc) {
  std::vector<std::unique_ptr<Listener<Image>>> listeners;
  for (const std::string camera : {"left/", "right/"}) {
    for (const std::string image :
         {"image_mono", "image_color", "image_rect", "image_rect_color"}) {
      listeners.push_back(std::make_unique<Listener<Image>>(rig_.nh(), camera + image));
    }
  }
  ASSERT_TRUE(eventually(all_links_are_up));
  std::vector<ros::Time> stamps;
  for (int i = 0; i < 5; ++i) {
    stamps.push_back(rig_.publish(color_pair(true)));
    for (const auto& listener : listeners) ASSERT_TRUE(listener->with_stamp(stamps.back()));
  }
  ros::WallDuration(0.5).sleep();
  for (const auto& listener : listeners) {
    for (const ros::Time& stamp : stamps) {
      const auto has_stamp = [&](const Image& image) { return image.header.stamp == stamp; };
      EXPECT_EQ(listener->count_if(has_stamp), 1U);
    }
  }
}

TEST_F(Swap, DepthImageProcFindsOurDepthWithoutRemaps) {
  const ros::Time stamp = rig_.publish(color_pair(true));
  const auto disparity = whole_disparity_.with_stamp(stamp);
  const auto cloud = depth_cloud_.with_stamp(stamp);
  ASSERT_TRUE(disparity && cloud);
  ASSERT_EQ(cloud->width, 160U);
  ASSERT_EQ(cloud->height, 120U);
  int valid = 0, wrong = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      const std::size_t point = y * cloud->row_step + x * cloud->point_step;
      const float d = float_at(disparity->image.data, (y * 160 + x) * 4);
      const float z = float_at(cloud->data, point + cloud->fields[2].offset);
      if (d <= 0) {
        wrong += std::isfinite(z);
        continue;
      }
      ++valid;
      const double depth = 300 * 0.1 / d;
      const double px = float_at(cloud->data, point + cloud->fields[0].offset);
      const double py = float_at(cloud->data, point + cloud->fields[1].offset);
      wrong += !(std::abs(z - depth) <= 1e-5 * depth);
      wrong += !(std::abs(px - (x - 80) * depth / 300) <= 1e-5 * depth);
      wrong += !(std::abs(py - (y - 60) * depth / 300) <= 1e-5 * depth);
    }
  }
  EXPECT_GT(valid, 160 * 120 / 3);
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace fpga_stereo::test
