// Parameters that are set before the node starts: allowed values hold, numbers out of range become
// the nearest allowed ones, others are refused and replaced by their defaults. Numbers of
// stereo_image_proc for the algorithm are understood, its parameters without a counterpart ignored.
#include <gtest/gtest.h>
#include <stereo_msgs/DisparityImage.h>

#include <algorithm>
#include <cmath>

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
  EXPECT_EQ(integer("correlation_window_size"), 21) << "the largest, instead of 51";
  EXPECT_EQ(integer("census_window_size"), 11) << "the next step, instead of 10";
  EXPECT_EQ(integer("num_threads"), 64) << "the largest, instead of 1000";
  std::string pattern;
  rig.nh().getParam("fpga_stereo/census_pattern", pattern);
  EXPECT_EQ(pattern, "sparse") << "7 is refused";
  std::string algorithm;
  rig.nh().getParam("fpga_stereo/stereo_algorithm", algorithm);
  EXPECT_EQ(algorithm, "window") << "0 means block matching in stereo_image_proc";
  EXPECT_EQ(message->valid_window.y_offset, 10U) << "window matching is used";
  double ratio = 0;
  rig.nh().getParam("fpga_stereo/uniqueness_ratio", ratio);
  EXPECT_EQ(ratio, 10) << "an integer is a number";
  double rate = -1;
  rig.nh().getParam("fpga_stereo/cloud_max_rate", rate);
  EXPECT_EQ(rate, 0) << "the smallest, instead of -1.5";
}

/// Checks the parameters of a namespace and returns what the node says about them.
ParameterReport checked(const ros::NodeHandle& nh) {
  ParameterReport report;
  check_parameters(nh, report);
  return report;
}

TEST(StartParameters, NumbersOutOfRangeBecomeTheNearestAllowedOnes) {
  ros::NodeHandle nh("~nearest");
  nh.setParam("disparity_range", 512);
  nh.setParam("min_disparity", -1000);
  nh.setParam("correlation_window_size", 14);
  nh.setParam("uniqueness_ratio", 100.5);
  nh.setParam("cloud_decimation", 0);
  nh.setParam("cloud_max_rate", 1e9);
  nh.setParam("census_window_size", 9);
  const ParameterReport report = checked(nh);
  EXPECT_TRUE(report.errors.empty());
  const std::vector<std::string> expected{
      "cloud_decimation = 0: allowed 1 to 16; using 1",
      "cloud_max_rate = 1e+09: allowed 0 to 1000; using 1000",
      "correlation_window_size = 14: allowed 5 to 21 in steps of 2; using 15",
      "disparity_range = 512: allowed 8 to 256 in steps of 4; using 256",
      "min_disparity = -1000: allowed -128 to 128; using -128",
      "uniqueness_ratio = 100.5: allowed 0 to 100; using 100"};
  EXPECT_EQ(report.warnings, expected);
  int range = 0;
  EXPECT_TRUE(nh.getParam("disparity_range", range));
  EXPECT_EQ(range, 256);
  EXPECT_TRUE(checked(nh).warnings.empty());
}

TEST(StartParameters, NamesTheUnknownOnes) {
  ros::NodeHandle nh("~unknown");
  ParameterReport report = checked(nh);
  load_sync_settings(nh, report);
  load_board_settings(nh, report);
  load_output_topics(nh, report);
  for (const std::string& name : report.names) nh.setParam(name, 1);
  nh.setParam("P1", 200);
  nh.setParam("image_transport", "compressed");
  nh.setParam("diagnostic_period", 1.0);
  nh.setParam("compressed/mode", "unchanged");
  EXPECT_EQ(report.names.count("serial_number"), 1U);
  EXPECT_EQ(report.names.count("keep_incomplete"), 1U);
  EXPECT_TRUE(unknown_parameters(nh, report.names).empty());

  nh.setParam("disparty_range", 96);
  nh.setParam("backends", "board");
  nh.setParam("exposure_time", 5);
  const std::vector<std::string> expected{
      "parameter backends is unknown and has no effect: did you mean backend?",
      "parameter disparty_range is unknown and has no effect: did you mean disparity_range?",
      "parameter exposure_time is unknown and has no effect"};
  std::vector<std::string> messages = unknown_parameters(nh, report.names);
  std::sort(messages.begin(), messages.end());
  EXPECT_EQ(messages, expected);
}

TEST(StartParameters, TranslatesTheAlgorithmsOfStereoImageProc) {
  ros::NodeHandle nh("~peer");
  EXPECT_FALSE(translate_algorithm(nh)) << "it is not set";
  const auto translated = [&](const auto& value) {
    nh.setParam("stereo_algorithm", value);
    const auto message = translate_algorithm(nh);
    EXPECT_TRUE(checked(nh).errors.empty());
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
    EXPECT_EQ(checked(nh).errors.at(0), "stereo_algorithm = " + std::to_string(other) +
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
  ParameterReport report;
  const BoardSettings none = load_board_settings(nh, report);
  EXPECT_TRUE(report.errors.empty());
  EXPECT_EQ(none.backend, Backend::kAuto);
  EXPECT_EQ(none.device, "usb");
  EXPECT_EQ(load_board_settings(ros::NodeHandle("/node"), report).frame_id,
            "stereo_left_optical_frame");
  EXPECT_EQ(load_board_settings(ros::NodeHandle("/robot/rear/node"), report).frame_id,
            "rear_left_optical_frame");

  nh.setParam("backend", "board");
  nh.setParam("board_input", "topics");
  nh.setParam("verify", 5);
  nh.setParam("mid_exposure", 8);
  nh.setParam("serial_number", 1234567);
  BoardSettings read = load_board_settings(nh, report);
  EXPECT_TRUE(report.errors.empty());
  EXPECT_EQ(read.backend, Backend::kBoard);
  EXPECT_TRUE(read.topic_input);
  EXPECT_EQ(read.verify, 5);
  EXPECT_EQ(read.mid_exposure_ms, 8) << "an integer is a number";
  EXPECT_EQ(read.device, "usb:match=^0*1234567$")
      << "the parameter server turns 0001234567 into a number";
  nh.setParam("serial_number", "FT0012");
  EXPECT_EQ(load_board_settings(nh, report).device, "usb:serial=FT0012");
  EXPECT_TRUE(report.errors.empty());

  nh.setParam("backend", "fpga");
  nh.setParam("verify", -3);
  nh.setParam("image_width", 5000);
  nh.setParam("mid_exposure", 1e6);
  read = load_board_settings(nh, report);
  EXPECT_EQ(read.backend, Backend::kAuto);
  EXPECT_EQ(read.verify, 0);
  EXPECT_EQ(read.image_size.width, 1280);
  EXPECT_EQ(read.mid_exposure_ms, 1000);
  EXPECT_EQ(
      report.errors,
      (std::vector<std::string>{"backend = fpga: allowed auto or board or software; using auto"}));
  const std::vector<std::string> expected{"image_width = 5000: allowed 16 to 1280; using 1280",
                                          "mid_exposure = 1e+06: allowed 0 to 1000; using 1000",
                                          "verify = -3: allowed 0 to 10000; using 0"};
  EXPECT_EQ(report.warnings, expected);
}

TEST(StartParameters, OfTheSynchronisation) {
  ros::NodeHandle nh("~sync");
  nh.setParam("queue_size", -3);
  nh.setParam("sync_tolerance", 11);
  ParameterReport report;
  EXPECT_EQ(load_sync_settings(nh, report).queue_size, 1);
  EXPECT_EQ(load_sync_settings(nh, report).sync_tolerance, 10);
  EXPECT_EQ(report.warnings.at(0), "queue_size = -3: allowed 1 to 1000; using 1");
  EXPECT_EQ(report.warnings.at(1), "sync_tolerance = 11: allowed more than 0 to 10; using 10");
  EXPECT_TRUE(report.errors.empty());
  nh.setParam("sync_tolerance", 0);
  EXPECT_EQ(load_sync_settings(nh, report).sync_tolerance, 0.1);
  EXPECT_EQ(report.errors.at(0), "sync_tolerance = 0: allowed more than 0 to 10; using 0.1")
      << "no number is the smallest above 0";
}

TEST(StartParameters, RefusesOtherTypesAndBadDevices) {
  ros::NodeHandle nh("/robot/front/types");
  nh.setParam("backend", 1);
  nh.setParam("device", "sreial:/dev/ttyUSB0");
  nh.setParam("verify", "10");
  nh.setParam("keep_incomplete", 1);
  nh.setParam("frame_id", 7);
  nh.setParam("mid_exposure", std::nan(""));
  nh.setParam("approximate_sync", 1);
  nh.setParam("sync_tolerance", "0.1");
  nh.setParam("disparity_range", "96");
  nh.setParam("uniqueness_ratio", std::nan(""));
  ParameterReport report;
  const BoardSettings board = load_board_settings(nh, report);
  EXPECT_EQ(board.device, "sreial:/dev/ttyUSB0") << "no other board is used instead";
  EXPECT_EQ(board.verify, 0);
  EXPECT_FALSE(board.keep_incomplete);
  EXPECT_FALSE(load_sync_settings(nh, report).approximate_sync);
  check_parameters(nh, report);
  const std::vector<std::string> expected{
      "backend = 1 (a whole number): allowed auto or board or software; using auto",
      "device: 'sreial:/dev/ttyUSB0' is not a transport: 'sreial' is not a kind of transport; "
      "allowed are usb, usb:serial=NUMBER, usb:port=BUS-PORT, usb:match=REGEX, serial:PATH[:BAUD], "
      "replay:FILE[:SPEED]; the node opens no board",
      "frame_id = 7 (a whole number): allowed text; using front_left_optical_frame",
      "mid_exposure = nan: allowed 0 to 1000; using 0",
      "verify = 10 (text): allowed 0 to 10000; using 0",
      "keep_incomplete = 1 (a whole number): allowed true or false; using false",
      "approximate_sync = 1 (a whole number): allowed true or false; using false",
      "sync_tolerance = 0.1 (text): allowed more than 0 to 10; using 0.1",
      "disparity_range = 96 (text): allowed 8 to 256 in steps of 4; using 64",
      "uniqueness_ratio = nan: allowed 0 to 100; using 33"};
  EXPECT_EQ(report.errors, expected);
  EXPECT_TRUE(report.warnings.empty());

  for (const char* device : {"usb:match=(", "usb:number=1", "serial:", "serial:/dev/x:0"}) {
    nh.setParam("device", device);
    ParameterReport one;
    load_board_settings(nh, one);
    ASSERT_GE(one.errors.size(), 2U) << device;
    EXPECT_EQ(one.errors[1].rfind("device: '", 0), 0U) << one.errors[1];
  }

  report.errors.clear();
  nh.setParam("device", "usb");
  nh.setParam("serial_number", 1e10);
  EXPECT_EQ(load_board_settings(nh, report).device, "usb:serial=1e+10")
      << "no board has this serial number";
  EXPECT_EQ(report.errors.at(1),
            "serial_number = 1e+10 (a number): allowed text: quote it; using 1e+10");
}

}  // namespace
}  // namespace fpga_stereo::test
