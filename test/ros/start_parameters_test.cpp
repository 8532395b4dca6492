// Parameters on the parameter server before the node starts: allowed ones hold, the others are
// refused and replaced by their defaults; those of stereo_image_proc do no harm.
#include <gtest/gtest.h>
#include <stereo_msgs/DisparityImage.h>

#include "fpga_stereo/ros/board_settings.hpp"
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

TEST(StartParameters, OfABoard) {
  ros::NodeHandle nh("~board");
  std::vector<std::string> refusals;
  const BoardSettings none = load_board_settings(nh, refusals);
  EXPECT_TRUE(refusals.empty());
  EXPECT_EQ(none.backend, Backend::kAuto);
  EXPECT_EQ(none.device, "usb");

  nh.setParam("backend", "board");
  nh.setParam("board_input", "topics");
  nh.setParam("verify", 5);
  nh.setParam("mid_exposure", 8);
  nh.setParam("serial_number", 1234567);
  BoardSettings read = load_board_settings(nh, refusals);
  EXPECT_TRUE(refusals.empty());
  EXPECT_EQ(read.backend, Backend::kBoard);
  EXPECT_TRUE(read.topic_input);
  EXPECT_EQ(read.verify, 5);
  EXPECT_EQ(read.mid_exposure_ms, 8) << "an integer is a number";
  EXPECT_EQ(read.device, "usb:serial=1234567") << "so is a serial number that looks like one";
  nh.setParam("serial_number", "FT0012");
  EXPECT_EQ(load_board_settings(nh, refusals).device, "usb:serial=FT0012");

  nh.setParam("backend", "fpga");
  nh.setParam("verify", -3);
  nh.setParam("image_width", 5000);
  read = load_board_settings(nh, refusals);
  EXPECT_EQ(read.backend, Backend::kAuto);
  EXPECT_EQ(read.verify, 0);
  EXPECT_EQ(read.image_size.width, 640);
  const std::vector<std::string> expected{
      "backend = fpga: allowed auto or board or software; using auto",
      "image_width = 5000: allowed 16 to 1280; using 640",
      "verify = -3: allowed 0 to 10000; using 0"};
  EXPECT_EQ(refusals, expected);
}

}  // namespace
}  // namespace fpga_stereo::test
