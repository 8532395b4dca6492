// The running node with a board that has cameras, behind a serial link.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>
#include <sensor_msgs/SetCameraInfo.h>
#include <std_srvs/Trigger.h>
#include <stereo_msgs/DisparityImage.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>

#include "ros/pty_board.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);

cv::Mat1b grey(const Image& message) {
  return cv::Mat1b(static_cast<int>(message.height), static_cast<int>(message.width),
                   const_cast<std::uint8_t*>(message.data.data()), message.step)
      .clone();
}

/// Returns true if the message has the disparity that core computes for the pair.
bool equals(const DisparityImage& message, const cv::Mat1w& expected) {
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      float value = 0;
      std::memcpy(&value, &message.image.data[y * message.image.step + x * 4], sizeof value);
      const float wanted = expected(y, x) == kNoDisparity
                               ? message.min_disparity - 1
                               : static_cast<float>(expected(y, x) / 32.0);
      if (value != wanted) return false;
    }
  }
  return true;
}

class Board : public testing::Test {
 protected:
  static std::string line() {
    std::string path;
    ros::param::get("~line", path);
    return path;
  }
  static void SetUpTestSuite() {
    std::remove((line() + "_left.yaml").c_str());
    std::remove((line() + "_right.yaml").c_str());
  }
  void TearDown() override {
    board_.reset();
    status_when(StereoStatus::LINK_CLOSED);  // the next test plugs in its own board
  }

  void plug_in(const sim::SoftwareBoard::Options& options = {}) {
    board_ = std::make_unique<PtyBoard>(line(), options);
    board_->watch({grey(pair_.left), grey(pair_.right)});
  }
  /// Waits for a status with this link state, source and state.
  StereoStatus status_when(std::optional<std::uint8_t> link_state, const std::string& source = "",
                           std::optional<std::uint8_t> state = std::nullopt) {
    return rig_.status_when([&](const StereoStatus& s) {
      return (!link_state || s.link_state == *link_state) &&
             s.source.find(source) != std::string::npos && (!state || s.state == *state);
    });
  }
  sensor_msgs::SetCameraInfoResponse set_camera_info(const std::string& side,
                                                     const CameraInfo& info) {
    sensor_msgs::SetCameraInfo call;
    call.request.camera_info = info;
    const std::string service = rig_.nh().resolveName(side + "/set_camera_info");
    EXPECT_TRUE(ros::service::waitForService(service, ros::Duration(10)) &&
                ros::service::call(service, call));
    return call.response;
  }
  bool calibrate(const std::string& side, const CameraInfo& info) {
    return set_camera_info(side, info).success != 0;
  }
  void calibrate() {
    ASSERT_TRUE(calibrate("left", pair_.left_info));
    ASSERT_TRUE(calibrate("right", pair_.right_info));
  }
  bool disparity_is_right(int more = 3) {
    const cv::Mat1w expected = core_disparity(pair_, window_parameters());
    const std::size_t before = disparity_.count();
    if (!eventually([&] { return disparity_.count() >= before + more; })) return false;
    return equals(*disparity_.last(), expected);
  }

  PairMessages pair_ = synthetic_pair(kSize, 12, true);
  Rig rig_;
  Listener<DisparityImage> disparity_{rig_.nh(), "disparity"};
  std::unique_ptr<PtyBoard> board_;
};

// This test runs first, while nothing is calibrated.
TEST_F(Board, IsCalibratedWithoutARestart) {
  plug_in();
  Listener<Image> left(rig_.nh(), "left/image_raw"), right(rig_.nh(), "right/image_raw");
  Listener<CameraInfo> info(rig_.nh(), "left/camera_info");
  ASSERT_TRUE(eventually([&] { return left.count() > 3 && right.count() > 3; }));
  EXPECT_EQ(grey(*left.last()).size(), kSize);
  EXPECT_EQ(cv::norm(grey(*left.last()), grey(pair_.left), cv::NORM_L1), 0);
  ASSERT_TRUE(eventually([&] { return info.count() > 0; }));
  EXPECT_EQ(info.last()->K[0], 0) << "uncalibrated";
  EXPECT_EQ(status_when(std::nullopt, "software", StereoStatus::UNCALIBRATED).state,
            StereoStatus::UNCALIBRATED);
  EXPECT_EQ(disparity_.count(), 0U);
  {
    Listener<Image> mono(rig_.nh(), "left/image_mono"), color(rig_.nh(), "right/image_color");
    ASSERT_TRUE(eventually([&] { return mono.count() > 0 && color.count() > 0; }));
    EXPECT_EQ(mono.last()->data, pair_.left.data);
    EXPECT_EQ(color.last()->data, pair_.right.data);
    EXPECT_EQ(mono.last()->header.frame_id, "stereo_left_optical_frame");
  }

  ASSERT_TRUE(calibrate("left", pair_.left_info));
  ASSERT_TRUE(always([&] { return disparity_.count() == 0; }, 2))
      << "the right camera is not calibrated yet";
  ASSERT_TRUE(calibrate("right", pair_.right_info));
  ASSERT_TRUE(disparity_is_right());
  EXPECT_EQ(status_when(StereoStatus::LINK_STREAMING, "board", StereoStatus::STREAMING).source,
            "board");
  const auto last = disparity_.last();
  EXPECT_EQ(last->header.frame_id, "stereo_left_optical_frame");
  EXPECT_NEAR((ros::Time::now() - last->header.stamp).toSec(), 0, 1);
  // All messages of a frame have one stamp.
  ASSERT_TRUE(left.with_stamp(disparity_.last()->header.stamp));
  ASSERT_TRUE(info.with_stamp(disparity_.last()->header.stamp));
  EXPECT_EQ(info.last()->K[0], pair_.left_info.K[0]);

  // The old calibration holds until both cameras agree on the new one.
  PairMessages moved = pair_;
  moved.left_info.P[0] *= 1.1;
  moved.left_info.P[5] *= 1.1;
  ASSERT_TRUE(calibrate("left", moved.left_info));
  ASSERT_TRUE(disparity_is_right(30));
  ASSERT_TRUE(calibrate("left", pair_.left_info));
}

TEST_F(Board, KeepsItsCalibrationWhenReplugged) {
  plug_in();
  ASSERT_TRUE(disparity_is_right()) << "calibrated from the file";
  for (int i = 0; i < 3; ++i) {
    board_->plug(false);
    const StereoStatus gone = status_when(StereoStatus::LINK_CLOSED, "software");
    EXPECT_EQ(gone.board.rfind("none: ", 0), 0U) << gone.board;
    board_->plug(true);
    ASSERT_TRUE(disparity_is_right());
  }
  EXPECT_EQ(status_when(StereoStatus::LINK_STREAMING, "board").source, "board");
}

TEST_F(Board, KeepsItsCalibrationIfANewOneCannotBeRight) {
  plug_in();
  ASSERT_TRUE(disparity_is_right());
  const auto contents = [](const std::string& side) {
    std::ostringstream text;
    text << std::ifstream(line() + "_" + side + ".yaml").rdbuf();
    return text.str();
  };
  const std::string left_file = contents("left"), right_file = contents("right");
  const auto expect_refused = [&](const std::string& side, const CameraInfo& info,
                                  const std::string& text) {
    const auto response = set_camera_info(side, info);
    EXPECT_FALSE(response.success) << text;
    EXPECT_EQ(response.status_message, text);
  };
  CameraInfo damaged = pair_.left_info;
  damaged.K[2] = std::nan("");
  expect_refused("left", damaged, "left camera_info K has a value that is not finite");
  damaged = pair_.right_info;
  damaged.width = 4294967295;
  expect_refused("right", damaged, "right camera_info width = 4294967295: allowed are 0 to 65535");
  const PairMessages small = synthetic_pair({80, 60}, 12, true);
  expect_refused("left", small.left_info,
                 "left camera_info is for images of 80x60: those of the camera are 160x120");
  expect_refused("right", CameraInfo(),
                 "right camera is uncalibrated: camera_info K[0] = 0; calibrate it first, for "
                 "example with camera_calibration");
  CameraInfo longer = pair_.left_info;
  longer.P[0] = longer.P[5] = 310;
  ASSERT_TRUE(calibrate("left", longer)) << "a half is accepted";
  expect_refused("right", pair_.right_info,
                 "neither calibration takes effect: fx of left and right camera_info P differ (310 "
                 "and 300): they must be equal for a rectified pair");
  EXPECT_TRUE(disparity_is_right());
  EXPECT_EQ(contents("left"), left_file);
  EXPECT_EQ(contents("right"), right_file);
  board_->plug(false);
  status_when(StereoStatus::LINK_CLOSED);
  board_->plug(true);
  EXPECT_TRUE(disparity_is_right());
}

TEST_F(Board, TakesNoOffenceAtTheCameraNameInAFile) {
  const std::string path = line() + "_left.yaml";
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const std::string own = "camera_name: stereo_left";
  std::string named = text.str();
  ASSERT_NE(named.find(own), std::string::npos) << named;
  named.replace(named.find(own), own.size(), "camera_name: narrow_stereo/left");
  std::ofstream(path) << named;
  Listener<rosgraph_msgs::Log> log(rig_.nh(), "/rosout");
  ASSERT_TRUE(eventually([&] { return log.count() > 0; }));
  plug_in();
  ASSERT_TRUE(disparity_is_right()) << "calibrated from the file";
  status_when(StereoStatus::LINK_STREAMING, "board", StereoStatus::STREAMING);
  EXPECT_EQ(log.count_if([](const rosgraph_msgs::Log& line) {
    return line.level >= rosgraph_msgs::Log::WARN && line.msg.find("match") != std::string::npos;
  }),
            0U);
}

TEST_F(Board, ItsLossIsAWarning) {
  Listener<rosgraph_msgs::Log> log(rig_.nh(), "/rosout");
  plug_in();
  ASSERT_TRUE(disparity_is_right());
  status_when(StereoStatus::LINK_STREAMING, "board", StereoStatus::STREAMING);
  ASSERT_TRUE(eventually([&] { return log.count() > 0; }));
  const auto warned = [&](const std::string& text) {
    return log.any([&](const rosgraph_msgs::Log& logged) {
      return logged.level == rosgraph_msgs::Log::WARN && logged.msg.find(text) != std::string::npos;
    });
  };
  board_->plug(false);
  EXPECT_TRUE(warned("the board is lost, so the software makes the disparity of the image topics"));
  EXPECT_TRUE(warned("no disparity: no images: nothing arrives on /stereo/left/image_raw"));
  EXPECT_EQ(status_when(StereoStatus::LINK_CLOSED, "software").state,
            StereoStatus::WAITING_FOR_IMAGES);
}

TEST_F(Board, CountersCountTheSameSpan) {
  Listener<diagnostic_msgs::DiagnosticArray> diagnostics(rig_.nh(), "/diagnostics");
  const auto value = [&](const std::string& key) {
    std::string found;
    for (const auto& status : diagnostics.last()->status) {
      for (const auto& each : status.values) {
        if (each.key == key) found = each.value;
      }
    }
    return found;
  };
  const auto number = [&](const std::string& key) { return std::stoull(value(key)); };
  plug_in();  // its cameras see pairs before it is configured
  ASSERT_TRUE(disparity_is_right(30));
  ASSERT_TRUE(eventually([&] { return diagnostics.count() > 0; }));
  const std::uint64_t bytes = number("bytes in"), packets = number("packets in");
  EXPECT_GT(bytes, packets * 44);
  board_->plug(false);
  status_when(StereoStatus::LINK_CLOSED);
  board_->plug(true);
  ASSERT_TRUE(disparity_is_right(3));
  rig_.status();
  EXPECT_GT(number("packets in"), packets);
  EXPECT_GT(number("bytes in"), bytes) << "bytes do not begin anew with a new connection";
  EXPECT_EQ(value("board: frames too long"), "0");
  EXPECT_EQ(value("board: frames cut"), "0");
}

TEST_F(Board, ReportsVerification) {
  plug_in();
  // Every second frame, even if all frames have raw images.
  Listener<Image> left(rig_.nh(), "left/image_raw");
  ASSERT_TRUE(eventually([&] { return left.count() > 0; }));
  ASSERT_TRUE(disparity_is_right());
  const StereoStatus before = rig_.status();
  const StereoStatus s = rig_.status_when(
      [&](const StereoStatus& r) { return r.verified_frames > before.verified_frames + 10; });
  EXPECT_GT(s.verified_frames, before.verified_frames + 10);
  EXPECT_LE(s.verified_frames - before.verified_frames,
            (s.frames_published - before.frames_published) / 2 + 2);
  EXPECT_EQ(s.verified_pixels_differ, 0U);
  board_.reset();

  sim::SoftwareBoard::Options wrong;
  wrong.wrong_pixels = 5;
  plug_in(wrong);
  const StereoStatus found =
      rig_.status_when([](const StereoStatus& r) { return r.verified_pixels_differ > 0; });
  EXPECT_GT(found.verified_pixels_differ, 0U);
  EXPECT_EQ(found.verified_pixels_differ % 5, 0U);
}

TEST_F(Board, FallsBackToTheSoftwareForUnsupportedSettings) {
  plug_in();
  ASSERT_TRUE(disparity_is_right());
  rig_.reconfigure("disparity_range", "32");
  const StereoStatus s = status_when(std::nullopt, "software", StereoStatus::STREAMING);
  EXPECT_EQ(s.source, "software");
  Parameters parameters = window_parameters();
  parameters.disparity_range = 32;
  const cv::Mat1w expected = core_disparity(pair_, parameters);
  EXPECT_TRUE(eventually([&] { return equals(*disparity_.last(), expected); }));
  rig_.reconfigure("disparity_range", "64");
  EXPECT_EQ(status_when(std::nullopt, "board", StereoStatus::STREAMING).source, "board");
  EXPECT_TRUE(disparity_is_right(30));
}

TEST_F(Board, IsAnnouncedOnceIfItsBuildDecidesAboutTheAlgorithm) {
  sim::SoftwareBoard::Options other;  // not the board of the tests before
  other.build.max_width = 656;
  Listener<rosgraph_msgs::Log> log(rig_.nh(), "/rosout");
  ASSERT_TRUE(eventually([&] { return log.count() > 0; }));
  const auto announcements = [&] {
    return log.count_if([](const rosgraph_msgs::Log& line) {
      return line.level == rosgraph_msgs::Log::INFO &&
             line.msg.find("the board is built for window matching") != std::string::npos;
    });
  };
  plug_in(other);
  ASSERT_TRUE(disparity_is_right());
  EXPECT_TRUE(eventually([&] { return announcements() == 1; }));
  board_->plug(false);
  status_when(StereoStatus::LINK_CLOSED);
  board_->plug(true);
  ASSERT_TRUE(disparity_is_right());
  rig_.status();
  EXPECT_EQ(announcements(), 1U);
  // A node that starts again must not take the default for a choice.
  EXPECT_TRUE(eventually([&] { return !rig_.nh().hasParam("fpga_stereo/stereo_algorithm"); }));
}

TEST_F(Board, IsRefusedIfItsSpecificationDiffers) {
  sim::SoftwareBoard::Options options;
  options.overrides = {{spec::kRegSpecHash, 0xDEADBEEF}};
  Listener<rosgraph_msgs::Log> log(rig_.nh(), "/rosout");
  ASSERT_TRUE(eventually([&] { return log.count() > 0; }));
  plug_in(options);
  const StereoStatus s = status_when(StereoStatus::LINK_REFUSED, "software");
  EXPECT_EQ(s.source, "software");
  std_srvs::Trigger info;
  ASSERT_TRUE(ros::service::call(rig_.nh().resolveName("fpga_stereo/device_info"), info));
  EXPECT_FALSE(info.response.success);
  EXPECT_NE(
      info.response.message.find("the board's gateware was built for specification 0xDEADBEEF"),
      std::string::npos)
      << info.response.message;
  EXPECT_TRUE(log.any([](const rosgraph_msgs::Log& line) {
    return line.level == rosgraph_msgs::Log::ERROR &&
           line.msg.find("specification 0xDEADBEEF") != std::string::npos;
  })) << "an error is logged also for a board that is plugged in later";
}

TEST_F(Board, ServicesResetAndDescribeIt) {
  plug_in();
  ASSERT_TRUE(disparity_is_right());
  const StereoStatus before = rig_.status();
  std_srvs::Trigger call;
  ASSERT_TRUE(ros::service::call(rig_.nh().resolveName("fpga_stereo/reset"), call));
  EXPECT_TRUE(call.response.success);
  const StereoStatus after =
      rig_.status_when([&](const StereoStatus& s) { return s.board_opened > before.board_opened; });
  EXPECT_EQ(after.board_opened, before.board_opened + 1);
  ASSERT_TRUE(disparity_is_right());
  ASSERT_TRUE(ros::service::call(rig_.nh().resolveName("fpga_stereo/device_info"), call));
  EXPECT_TRUE(call.response.success);
  EXPECT_NE(call.response.message.find("640 px wide, 64 disparities"), std::string::npos);
}

TEST(BoardIdle, SendsOnlyStreamsInDemandAndLosesNothing) {
  std::string line;
  ros::param::get("~line", line);
  PtyBoard board(line, sim::SoftwareBoard::Options{});
  const PairMessages pair = synthetic_pair(kSize, 12, true);
  board.watch({grey(pair.left), grey(pair.right)});
  Rig rig;
  rig.status_when([](const StereoStatus& s) { return s.link_state == StereoStatus::LINK_READY; });
  EXPECT_EQ(board.peek(spec::kRegStreams), 0U);
  const StereoStatus before = rig.status();
  {
    Listener<Image> rect(rig.nh(), "left/image_rect");
    EXPECT_TRUE(eventually([&] { return rect.count() > 2; }));
    EXPECT_EQ(board.peek(spec::kRegStreams), spec::kStreamsRectifiedLeft.mask());
  }
  EXPECT_TRUE(eventually([&] { return board.peek(spec::kRegStreams) == 0; }));
  std::this_thread::sleep_for(std::chrono::seconds(1));  // the board numbers its frames on
  Listener<Image> raw(rig.nh(), "left/image_raw");
  const StereoStatus again = rig.status_when([](const StereoStatus& s) { return s.rate > 10; });
  EXPECT_GT(again.latency_ms, 0) << "raw images count as published frames";
  EXPECT_LT(again.latency_ms, 1000);
  EXPECT_GT(again.board_latency_p50_ms, 0);
  EXPECT_EQ(again.dropped_link, before.dropped_link) << "frames without subscribers are not lost";
}

TEST(BoardIdle, WorksWithoutStreamsThatTheBuildLacks) {
  std::string line;
  ros::param::get("~line", line);
  sim::SoftwareBoard::Options options;
  options.streams = {link::Stream::kDisparity, link::Stream::kRawLeft};
  PtyBoard board(line, options);
  const PairMessages pair = synthetic_pair(kSize, 12, true);
  board.watch({grey(pair.left), grey(pair.right)});
  Rig rig;
  Listener<Image> rect(rig.nh(), "left/image_rect"), right(rig.nh(), "right/image_raw");
  Listener<DisparityImage> disparity(rig.nh(), "disparity");
  EXPECT_TRUE(eventually([&] { return rect.count() > 2 && disparity.count() > 2; }));
  EXPECT_EQ(right.count(), 0U) << "the build does not send it";
}

// This test is the last one with this board: it chooses an algorithm, which cannot be undone.
TEST_F(Board, LeavesAnAlgorithmThatItIsNotBuiltForToTheSoftware) {
  plug_in();
  ASSERT_TRUE(disparity_is_right());
  rig_.reconfigure("dense", "true");  // the build decides about the algorithm still
  EXPECT_EQ(status_when(std::nullopt, "software", StereoStatus::STREAMING).source, "software");
  Parameters parameters = window_parameters();
  parameters.dense = true;
  const cv::Mat1w dense = core_disparity(pair_, parameters);
  EXPECT_TRUE(eventually([&] { return equals(*disparity_.last(), dense); }));
  rig_.reconfigure("dense", "false");
  EXPECT_EQ(status_when(std::nullopt, "board", StereoStatus::STREAMING).source, "board");

  rig_.reconfigure("stereo_algorithm", "window");
  rig_.reconfigure("stereo_algorithm", "sgm");
  EXPECT_EQ(status_when(std::nullopt, "software", StereoStatus::STREAMING).source, "software");
  const cv::Mat1w sgm = core_disparity(pair_, {});
  EXPECT_TRUE(eventually([&] { return equals(*disparity_.last(), sgm); }));
  EXPECT_TRUE(rig_.nh().hasParam("fpga_stereo/stereo_algorithm"));
  rig_.reconfigure("stereo_algorithm", "window");
  EXPECT_EQ(status_when(std::nullopt, "board", StereoStatus::STREAMING).source, "board");
  EXPECT_TRUE(disparity_is_right(30));
}

}  // namespace
}  // namespace fpga_stereo::test
