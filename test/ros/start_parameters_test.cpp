// Parameters that are set before the node starts: allowed values hold, others are refused and
// replaced by their defaults. Numbers of stereo_image_proc for the algorithm are understood, and
// its parameters without a counterpart ignored.
#include <gtest/gtest.h>
#include <stereo_msgs/DisparityImage.h>

#include "ros/board_settings.hpp"
#include "ros/rig.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo::test {
namespace {

TEST(StartParameters, AllowedValuesHoldAndOthersAreReplaced) {
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
  std::string algorithm;
  rig.nh().getParam("fpga_stereo/stereo_algorithm", algorithm);
  EXPECT_EQ(algorithm, "window") << "0 means block matching in stereo_image_proc";
  EXPECT_EQ(message->valid_window.y_offset, 7U) << "window matching is used";
  double ratio = 0;
  rig.nh().getParam("fpga_stereo/uniqueness_ratio", ratio);
  EXPECT_EQ(ratio, 10) << "an integer is a number";
}

TEST(StartParameters, TranslatesTheAlgorithmsOfStereoImageProc) {
  ros::NodeHandle nh("~peer");
  EXPECT_FALSE(translate_algorithm(nh)) << "it is not set";
  const auto translated = [&](const auto& value) {
    nh.setParam("stereo_algorithm", value);
    const auto message = translate_algorithm(nh);
    EXPECT_TRUE(refuse_bad_parameters(nh).empty());
    std::string word;
    EXPECT_TRUE(nh.getParam("stereo_algorithm", word));
    return word + ": " + message.value_or("");
  };
  const std::string block =
      "window: stereo_algorithm = 0 of stereo_image_proc (block matching) means window in this "
      "node";
  const std::string global =
      "sgm: stereo_algorithm = 1 of stereo_image_proc (semi-global block matching) means sgm in "
      "this node";
  EXPECT_EQ(translated(0), block);
  EXPECT_EQ(translated("0"), block);
  EXPECT_EQ(translated(1), global);
  EXPECT_EQ(translated("1"), global);
  EXPECT_EQ(translated("window"), "window: ");
  EXPECT_EQ(translated("sgm"), "sgm: ");

  for (const int other : {2, -1}) {
    nh.setParam("stereo_algorithm", other);
    EXPECT_FALSE(translate_algorithm(nh));
    EXPECT_EQ(refuse_bad_parameters(nh).at(0),
              "stereo_algorithm = " + std::to_string(other) +
                  " (a whole number): allowed window or sgm; using sgm");
    EXPECT_FALSE(nh.hasParam("stereo_algorithm"));
  }
}

TEST(StartParameters, NamesTheCounterpartsOfIgnoredOnes) {
  ros::NodeHandle nh("~ignored");
  EXPECT_TRUE(ignored_parameters(nh).empty());
  nh.setParam("stereo_algorithm", 1);
  nh.setParam("prefilter_cap", 31);
  nh.setParam("P1", 200);
  nh.setParam("P2", 400);
  nh.setParam("fullDP", true);
  const std::vector<std::string> expected{
      "parameter prefilter_cap of stereo_image_proc has no effect in this node",
      "parameter P1 of stereo_image_proc has no effect in this node; this node has sgm_p1, on "
      "another scale",
      "parameter P2 of stereo_image_proc has no effect in this node; this node has sgm_p2, "
      "sgm_p2_edge and sgm_p2_strong_edge, on another scale",
      "parameter fullDP of stereo_image_proc has no effect in this node; this node has sgm_build"};
  EXPECT_EQ(ignored_parameters(nh), expected);
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
  EXPECT_EQ(read.device, "usb:match=^0*1234567$")
      << "the parameter server turns 0001234567 into a number";
  nh.setParam("serial_number", "FT0012");
  EXPECT_EQ(load_board_settings(nh, refusals).device, "usb:serial=FT0012");
  EXPECT_TRUE(refusals.empty());

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

TEST(StartParameters, RefusesOtherTypesAndDevicesWithoutAnswers) {
  ros::NodeHandle nh("~types");
  nh.setParam("backend", 1);
  nh.setParam("device", "replay:/tmp/link.bin");
  nh.setParam("verify", "10");
  nh.setParam("keep_incomplete", 1);
  nh.setParam("frame_id", 7);
  nh.setParam("approximate_sync", 1);
  nh.setParam("sync_tolerance", "0.1");
  nh.setParam("disparity_range", "96");
  std::vector<std::string> refusals;
  const BoardSettings board = load_board_settings(nh, refusals);
  EXPECT_EQ(board.device, "usb");
  EXPECT_EQ(board.verify, 0);
  EXPECT_FALSE(board.keep_incomplete);
  EXPECT_FALSE(load_sync_settings(nh, refusals).approximate_sync);
  for (const std::string& refusal : refuse_bad_parameters(nh)) refusals.push_back(refusal);
  const std::vector<std::string> expected{
      "backend = 1 (a whole number): allowed auto or board or software; using auto",
      "device = replay:/tmp/link.bin: allowed usb... or serial:... (a recording cannot answer "
      "requests; 'board capture' shows it); using usb",
      "frame_id = 7 (a whole number): allowed text; using stereo_left_optical_frame",
      "verify = 10 (text): allowed 0 to 10000; using 0",
      "keep_incomplete = 1 (a whole number): allowed true or false; using false",
      "approximate_sync = 1 (a whole number): allowed true or false; using false",
      "sync_tolerance = 0.1 (text): allowed more than 0 to 10; using 0.1",
      "disparity_range = 96 (text): allowed 8 to 256 in steps of 4; using 64"};
  EXPECT_EQ(refusals, expected);

  refusals.clear();
  nh.setParam("device", "usb");
  nh.setParam("serial_number", 1e10);
  EXPECT_EQ(load_board_settings(nh, refusals).device, "usb:serial=1e+10")
      << "no board has this serial number";
  EXPECT_EQ(refusals.at(1),
            "serial_number = 1e+10 (a number): allowed text: quote it; using 1e+10");
}

}  // namespace
}  // namespace fpga_stereo::test
