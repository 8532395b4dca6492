// The node with the recording of a link as its device: it publishes what the board computed only if
// it knows how it was made.
#include "link/recording.hpp"

#include <camera_calibration_parsers/parse.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <std_srvs/Trigger.h>
#include <stereo_msgs/DisparityImage.h>
#include <unistd.h>

#include <atomic>
#include <cstring>

#include "fpga_stereo/link/board_plan.hpp"
#include "fpga_stereo/link/device.hpp"
#include "ros/conversions.hpp"
#include "ros/graph.hpp"
#include "ros/pty_board.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using sensor_msgs::Image;
using stereo_msgs::DisparityImage;

const cv::Size kSize(160, 120);
constexpr const char* kName = "/stereo/fpga_stereo";
constexpr int kFrames = 10;

cv::Mat1b grey(const Image& message) {
  return cv::Mat1b(static_cast<int>(message.height), static_cast<int>(message.width),
                   const_cast<std::uint8_t*>(message.data.data()), message.step)
      .clone();
}

/// Returns the disparity of the message in core's numbers.
cv::Mat1w numbers(const DisparityImage& message) {
  cv::Mat1w result(static_cast<int>(message.image.height), static_cast<int>(message.image.width));
  for (int y = 0; y < result.rows; ++y) {
    for (int x = 0; x < result.cols; ++x) {
      float value = 0;
      std::memcpy(&value, &message.image.data[y * message.image.step + x * 4], sizeof value);
      result(y, x) = value < message.min_disparity
                         ? kNoDisparity
                         : static_cast<std::uint16_t>((value - message.min_disparity) * 32);
    }
  }
  return result;
}

class RecordingOfALink : public testing::Test {
 protected:
  RecordingOfALink() : path_("/tmp/fpga_stereo_recording_" + std::to_string(getpid())) {}

  void SetUp() override { ros::param::del(kName); }
  void TearDown() override {
    loader_.unload(kName);
    ros::param::del(kName);
    eventually([] { return !ros::service::exists(std::string(kName) + "/set_parameters", false); });
    for (const char* end : {"", ".rec", "_left.yaml", "_right.yaml"}) unlink((path_ + end).c_str());
  }

  /// Records kFrames frame sets. `keeps`: the configuration is made before, and so not recorded.
  void record(const link::BoardDemand& demand, bool keeps = false) {
    PtyBoard board(path_, sim::SoftwareBoard::Options{});
    board.watch({grey(pair_.left), grey(pair_.right)});
    if (keeps) run(board, demand, false, false);
    run(board, demand, true, keeps);
  }
  template <class Value>
  static void set(const std::string& name, const Value& value) {
    ros::param::set(std::string(kName) + "/" + name, value);
  }
  void load(const PairMessages& calibration, const std::string& speed = "") {
    write(path_ + "_left.yaml", calibration.left_info);
    write(path_ + "_right.yaml", calibration.right_info);
    set("device", "replay:" + path_ + ".rec" + speed);
    set("left_info_url", "file://" + path_ + "_left.yaml");
    set("right_info_url", "file://" + path_ + "_right.yaml");
    ASSERT_TRUE(loader_.load(kName, "fpga_stereo/stereo", {}, {}));
  }
  StereoStatus status_with(std::uint8_t state) {
    return rig_.status_when([&](const StereoStatus& s) { return s.state == state; });
  }

  const std::string path_;
  PairMessages pair_ = synthetic_pair(kSize, 12, true);
  Parameters parameters_ = [] {
    Parameters p = window_parameters();
    p.min_disparity = 2;
    p.speckle_size = 30;
    return p;
  }();
  Rig rig_;
  nodelet::Loader loader_{false};

 private:
  static void write(const std::string& path, const sensor_msgs::CameraInfo& info) {
    ASSERT_TRUE(camera_calibration_parsers::writeCalibration(path, "camera", info));
  }
  void run(PtyBoard&, const link::BoardDemand& demand, bool is_recorded, bool keeps) {
    link::BoardPlan plan({});
    plan.set_parameters(parameters_);
    plan.set_calibration(
        {*to_calibration(pair_.left_info, "left"), *to_calibration(pair_.right_info, "right")});
    plan.set_demand(demand);
    std::atomic<int> frames{0};
    std::unique_ptr<link::Device> device;
    link::Device::Options options;
    options.open = [&]() -> Result<std::unique_ptr<link::Transport>> {
      auto line = link::open_transport("serial:" + path_);
      if (!line || !is_recorded) return line;
      auto recorder = link::Recorder::open(std::move(*line), path_ + ".rec");
      if (!recorder) return recorder.error();
      return std::unique_ptr<link::Transport>(std::move(*recorder));
    };
    link::Device::Callbacks callbacks;
    callbacks.received = [&](const link::ReceivedFrames&) { ++frames; };
    callbacks.identified = [&](const link::Identity& identity) {
      plan.set_identity(identity);
      link::DesiredState desired = plan.desired_state();
      desired.keep_configuration = keeps;
      device->set_desired_state(desired);
    };
    std::mutex made;
    {
      const std::lock_guard<std::mutex> lock(made);
      auto identified = callbacks.identified;
      callbacks.identified = [&, identified](const link::Identity& identity) {
        const std::lock_guard<std::mutex> wait(made);
        identified(identity);
      };
      device = std::make_unique<link::Device>(std::move(options), std::move(callbacks));
    }
    EXPECT_TRUE(eventually([&] { return frames >= kFrames; }, 20));
  }
};

TEST_F(RecordingOfALink, IsPublishedAsTheBoardComputedIt) {
  link::BoardDemand demand;
  demand.disparity = demand.rectified_left = demand.raw_left = demand.raw_right = true;
  record(demand);
  set("verify", 1);
  set("min_disparity", 2);
  load(pair_, ":0.2");
  std_srvs::Trigger reset;
  ASSERT_TRUE(ros::service::call(std::string(kName) + "/reset", reset));
  EXPECT_FALSE(reset.response.success);
  EXPECT_EQ(reset.response.message, "no board is connected: device is a recording");

  Listener<DisparityImage> disparity(rig_.nh(), "disparity");
  Listener<Image> raw(rig_.nh(), "left/image_raw");
  const StereoStatus streaming = status_with(StereoStatus::STREAMING);
  EXPECT_EQ(streaming.state_text, "streaming from replay:" + path_ + ".rec:0.2");
  EXPECT_EQ(streaming.source, "board");
  const StereoStatus end = status_with(StereoStatus::RECORDING_ENDED);
  EXPECT_EQ(end.state_text, "the recording " + path_ + ".rec has ended");
  EXPECT_GE(disparity.count(), static_cast<std::size_t>(kFrames - 2));
  EXPECT_EQ(end.dropped_link, 0U);
  EXPECT_EQ(end.verified_frames, end.frames_published);
  EXPECT_EQ(end.verified_pixels_differ, 0U);

  const auto last = disparity.last();
  ASSERT_TRUE(last);
  EXPECT_EQ(last->min_disparity, 2);
  EXPECT_EQ(last->valid_window.y_offset, 7U) << "window matching as recorded, not the node's sgm";
  EXPECT_EQ(cv::norm(numbers(*last), core_disparity(pair_, parameters_), cv::NORM_L1), 0);
  EXPECT_EQ(last->f, pair_.left_info.P[0]);
  ASSERT_TRUE(raw.with_stamp(last->header.stamp));
  EXPECT_EQ(cv::norm(grey(*raw.last()), grey(pair_.left), cv::NORM_L1), 0);
}

TEST_F(RecordingOfALink, IsRefusedWithAnotherCalibration) {
  link::BoardDemand demand;
  demand.disparity = true;
  record(demand);
  PairMessages moved = pair_;
  moved.left_info.D[0] *= 1.5;
  set("min_disparity", 2);
  load(moved, ":0.2");
  Listener<DisparityImage> disparity(rig_.nh(), "disparity");
  const StereoStatus status = status_with(StereoStatus::BOARD_UNSUITABLE);
  EXPECT_EQ(status.state_text,
            "recorded frame dropped: left_info_url, right_info_url and min_disparity are not those "
            "that it was made with, and the raw images that the software needs are not recorded");
  status_with(StereoStatus::RECORDING_ENDED);
  EXPECT_EQ(disparity.count(), 0U);
}

TEST_F(RecordingOfALink, IsRefusedWithoutItsConfiguration) {
  link::BoardDemand demand;
  demand.disparity = true;
  record(demand, true);
  load(pair_, ":0.2");
  Listener<DisparityImage> disparity(rig_.nh(), "disparity");
  const StereoStatus status = status_with(StereoStatus::BOARD_UNSUITABLE);
  EXPECT_NE(status.state_text.find("does not contain the configuration that made it"),
            std::string::npos)
      << status.state_text;
  status_with(StereoStatus::RECORDING_ENDED);
  EXPECT_EQ(disparity.count(), 0U);
}

TEST_F(RecordingOfALink, RawImagesGoThroughTheSoftware) {
  link::BoardDemand demand;
  demand.raw_left = demand.raw_right = true;
  record(demand, true);
  set("stereo_algorithm", "window");
  load(pair_, ":0.2");
  Listener<DisparityImage> disparity(rig_.nh(), "disparity");
  const StereoStatus streaming = status_with(StereoStatus::STREAMING);
  EXPECT_EQ(streaming.source, "software");
  ASSERT_TRUE(eventually([&] { return disparity.count() > 0; }));
  EXPECT_EQ(
      cv::norm(numbers(*disparity.last()), core_disparity(pair_, window_parameters()), cv::NORM_L1),
      0)
      << "the node's own parameters";
}

TEST_F(RecordingOfALink, ThatIsMissingLeavesTheTopics) {
  load(pair_);
  const StereoStatus status = rig_.status_when(
      [](const StereoStatus& s) { return s.board.find("cannot be opened") != std::string::npos; });
  EXPECT_EQ(status.board.rfind("none: the recording " + path_ + ".rec cannot be opened", 0), 0U)
      << status.board;
  Listener<DisparityImage> disparity(rig_.nh(), "disparity");
  // The calibration comes from the files, not from topics.
  ASSERT_TRUE(eventually([this] {
    const Rig::Subscribers s = rig_.subscribers();
    return s.left > 0 && s.right > 0 && all_links_are_up();
  }));
  EXPECT_TRUE(disparity.with_stamp(rig_.publish(pair_)));
}

}  // namespace
}  // namespace fpga_stereo::test
