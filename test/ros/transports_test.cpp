// As rosbag record -a: subscribers of every topic in every transport; nothing complains.
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/String.h>
#include <stereo_msgs/DisparityImage.h>

#include <memory>
#include <set>

#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

const std::string kPrefix = "/stereo/";

std::set<std::string> transports_of(const std::string& image) {
  std::set<std::string> transports;
  for (const auto& [topic, type] : types_by_topic(kPrefix + image + "/")) {
    if (type == "std_msgs/String") transports.insert(topic);
  }
  return transports;
}

TEST(Transports, OnlyThoseThatCanEncodeTheImagesAreAdvertised) {
  using Names = std::set<std::string>;
  Rig rig;
  rig.status();
  for (const std::string image :
       {"left/image_mono", "left/image_color", "left/image_rect", "left/image_rect_color",
        "right/image_mono", "right/image_color", "right/image_rect_color", "disparity_color"}) {
    EXPECT_EQ(transports_of(image), (Names{"compressed", "theora"})) << image;
  }
  EXPECT_EQ(transports_of("right/image_rect"), (Names{"compressed"})) << "as the user has set";
  EXPECT_EQ(transports_of("depth/image_rect"), (Names{"compressedDepth"}));
  EXPECT_EQ(types_by_topic(kPrefix).count("depth/compressedDepth"), 1U);
  EXPECT_EQ(types_by_topic(kPrefix).count("depth/compressed"), 0U);
  EXPECT_EQ(types_by_topic(kPrefix).count("depth/theora"), 0U);
}

TEST(Transports, RecordingEveryTopicCausesNoWarning) {
  Rig rig;
  rig.status();
  ros::NodeHandle root;
  Listener<rosgraph_msgs::Log> log(root, "/rosout");
  Listener<stereo_msgs::DisparityImage> disparity(rig.nh(), "disparity");
  Listener<sensor_msgs::PointCloud2> cloud(rig.nh(), "points2");
  std::vector<std::unique_ptr<Listener<sensor_msgs::Image>>> images;
  std::vector<std::unique_ptr<Listener<std_msgs::String>>> encoded;
  for (const auto& [topic, type] : types_by_topic(kPrefix)) {
    if (type == "sensor_msgs/Image") {
      images.push_back(std::make_unique<Listener<sensor_msgs::Image>>(rig.nh(), topic));
    } else if (type == "std_msgs/String") {
      encoded.push_back(std::make_unique<Listener<std_msgs::String>>(rig.nh(), topic));
    }
  }
  EXPECT_EQ(encoded.size(), 19U) << "two of nine images, one of one, one of two depths";
  ASSERT_TRUE(rig.node_listens());
  for (const std::string depth : {"32FC1", "16UC1"}) {
    rig.reconfigure("depth_encoding", depth);
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(disparity.with_stamp(rig.publish(synthetic_pair({160, 120}, 12))));
    }
  }
  rig.reconfigure("depth_encoding", "32FC1");
  rig.status();
  for (const auto& messages : encoded) EXPECT_EQ(messages->count(), 6U);
  EXPECT_EQ(log.count_if([](const rosgraph_msgs::Log& m) {
    if (m.level >= rosgraph_msgs::Log::WARN) ADD_FAILURE() << m.name << ": " << m.msg;
    return m.level >= rosgraph_msgs::Log::WARN;
  }),
            0U);
}

TEST(Transports, RemappedTopicsAreFoundInEveryTransport) {
  Rig rig("front", "other/copied");
  Listener<stereo_msgs::DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  EXPECT_TRUE(disparity.with_stamp(rig.publish(synthetic_pair({160, 120}, 12))));
}

}  // namespace
}  // namespace fpga_stereo::test
