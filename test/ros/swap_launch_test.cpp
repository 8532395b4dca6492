// What stereo_image_proc's launch file publishes, the launch file in its place publishes as well.
#include <gtest/gtest.h>

#include <set>

#include "ros/graph.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

TEST(SwapLaunch, PublishesEveryTopicOfThePeersFileOnce) {
  std::map<std::string, std::string> ours, theirs;
  ASSERT_TRUE(eventually(
      [&] {
        ours = types_by_topic("/ours/");
        theirs = types_by_topic("/peer/");
        return ours.count("points2") != 0 && ours.count("disparity/status") != 0 &&
               theirs.count("points2") != 0 && theirs.count("disparity") != 0 &&
               theirs.count("right/image_rect_color") != 0;
      },
      60));
  // Topics of the nodelets themselves: bonds, dynamic_reconfigure of image_proc.
  const std::set<std::string> of_nodelets{"manager/bond"};
  for (const auto& [topic, type] : theirs) {
    const bool is_reconfigure = topic.find("/parameter_") != std::string::npos;
    if (of_nodelets.count(topic) != 0 || is_reconfigure) continue;
    EXPECT_EQ(ours.count(topic), 1U) << topic;
    if (ours.count(topic) == 0) continue;
    EXPECT_EQ(ours.at(topic), type) << topic;
  }
  std::set<std::string> additional;
  for (const auto& [topic, type] : ours) {
    if (theirs.count(topic) == 0) additional.insert(topic);
  }
  EXPECT_EQ(additional, (std::set<std::string>{"depth", "depth/camera_info", "depth/image_rect",
                                               "disparity/status", "disparity_color"}));
  for (const auto& [topic, nodes] : publishers_by_topic()) {
    if (topic.rfind("/ours/", 0) != 0) continue;
    EXPECT_EQ(nodes.size(), 1U) << topic;
  }
}

}  // namespace
}  // namespace fpga_stereo::test
