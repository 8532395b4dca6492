// Parameters on the parameter server before the node starts: allowed ones hold, the others are
// refused and replaced by their defaults; those of stereo_image_proc do no harm.
#include <gtest/gtest.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

TEST(StartParameters, GoodOnesHoldAndBadOnesAreReplaced) {
  Rig rig;
  Listener<stereo_msgs::DisparityImage> disparity(rig.nh(), "disparity");
  ASSERT_TRUE(rig.node_listens());
  const auto message = disparity.with_stamp(rig.publish(synthetic_pair({160, 120}, 12)));
  ASSERT_TRUE(message);
  EXPECT_EQ(message->max_disparity, 95);

  const auto integer = [&](const std::string& name) {
    int value = -1;
    rig.nh().getParam("fpga_stereo/" + name, value);
    return value;
  };
  EXPECT_EQ(integer("disparity_range"), 96) << "allowed";
  EXPECT_EQ(integer("speckle_size"), 100) << "allowed";
  EXPECT_EQ(integer("correlation_window_size"), 15) << "51 is refused";
  EXPECT_EQ(integer("census_window_size"), 11) << "10 is refused";
  EXPECT_EQ(integer("num_threads"), 0) << "1000 is refused";
  std::string pattern;
  rig.nh().getParam("fpga_stereo/census_pattern", pattern);
  EXPECT_EQ(pattern, "sparse") << "7 is refused";
  double ratio = 0;
  rig.nh().getParam("fpga_stereo/uniqueness_ratio", ratio);
  EXPECT_EQ(ratio, 10) << "an integer is a number";
}

}  // namespace
}  // namespace fpga_stereo::test
