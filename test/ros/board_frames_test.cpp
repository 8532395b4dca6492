// Checks of what a board sends, the frames made from it, and the reports about a board.
#include "ros/board_frames.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <gtest/gtest.h>
#include <ros/console.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "ros/board_report.hpp"
#include "ros/conversions.hpp"
#include "ros/health.hpp"
#include "ros/rectification_log.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::PlannedConfiguration;
using link::Stream;

const cv::Size kSize(64, 48);

cv::Mat& image(link::FrameSet& set, Stream stream) {
  return set.images[static_cast<std::size_t>(stream)];
}

PlannedConfiguration planned_for(const PairMessages& pair) {
  PlannedConfiguration planned;
  planned.calibration = {*to_calibration(pair.left_info, "left"),
                         *to_calibration(pair.right_info, "right")};
  planned.image_size = kSize;
  RectificationCache cache;
  planned.rectification = *cache.get(planned.calibration, 0);
  return planned;
}

StereoFrame frame_of(const link::ReceivedFrames& received, const PlannedConfiguration& planned,
                     const Demand& demand = {}) {
  const SourcePair pair = camera_pair(received.set, planned, ros::Time(1, 0), "left", 1);
  return frame_of_camera_pair(received, planned, pair, {}, demand);
}

TEST(BoardFrames, RefusesStampsThatRosCannotHold) {
  ASSERT_TRUE(to_stamp(1.5));
  EXPECT_EQ(*to_stamp(1.5), ros::Time(1, 500000000));
  for (const double bad :
       {0.0, -1.0, 4294967295.0, 1.8e13, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(to_stamp(bad)) << bad;
  }
  EXPECT_EQ(to_stamp(-1).error().message,
            "board frame dropped: its stamp is -1.000000 s, allowed are 0 to 4294967295 s");
}

TEST(BoardFrames, RefusesImagesOfAnotherSize) {
  link::FrameSet set;
  EXPECT_TRUE(check_sizes(set, kSize));
  image(set, Stream::kDisparity) = cv::Mat1w(kSize);
  image(set, Stream::kRawLeft) = cv::Mat1b(kSize);
  EXPECT_TRUE(check_sizes(set, kSize));
  image(set, Stream::kRawLeft) = cv::Mat1b(32, 64);
  const Status wrong = check_sizes(set, kSize);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message,
            "board frame dropped: its raw left image is 64x32 instead of 64x48");
}

TEST(BoardFrames, DoesNotPublishAShiftedRightImage) {
  PlannedConfiguration planned = planned_for(synthetic_pair(kSize, 4));
  link::ReceivedFrames received;
  image(received.set, Stream::kRectifiedRight) = cv::Mat1b(kSize, 7);
  EXPECT_FALSE(frame_of(received, planned).right.rect.empty());
  planned.parameters.min_disparity = 8;
  EXPECT_TRUE(frame_of(received, planned).right.rect.empty());
}

TEST(BoardFrames, RectifiesRawImagesThatTheBoardDoesNotRectify) {
  const PairMessages pair = synthetic_pair(kSize, 4, true);
  const PlannedConfiguration planned = planned_for(pair);
  link::ReceivedFrames received;
  image(received.set, Stream::kRawLeft) = cv::Mat1b(kSize, 100);
  Demand demand;
  demand.left.rect = true;
  const StereoFrame frame = frame_of(received, planned, demand);
  cv::Mat expected;
  rectify_image(cv::Mat1b(kSize, 100), planned.rectification->left.mesh, 1, expected);
  ASSERT_EQ(frame.left.rect.size(), kSize);
  EXPECT_EQ(cv::norm(frame.left.rect, expected, cv::NORM_L1), 0);
  EXPECT_TRUE(frame.disparity.empty());
}

TEST(BoardFrames, ACameraPairSharesTheImagesOfTheSet) {
  const PlannedConfiguration planned = planned_for(synthetic_pair(kSize, 4, true));
  link::FrameSet set;
  image(set, Stream::kRawLeft) = cv::Mat1b(kSize, 100);
  const SourcePair pair = camera_pair(set, planned, ros::Time(7, 8), "left", 3);
  EXPECT_EQ(pair.raw.left.data, image(set, Stream::kRawLeft).data);
  EXPECT_TRUE(pair.raw.right.empty());
  EXPECT_EQ(pair.raw.calibration, planned.calibration);
  EXPECT_EQ(pair.left_header().stamp, ros::Time(7, 8));
  EXPECT_EQ(pair.left_info->header.frame_id, "left");
  EXPECT_EQ(pair.number, 3U);
}

TEST(BoardFrames, NamesWhatAFrameLacks) {
  const PairMessages messages = synthetic_pair(kSize, 4);
  PlannedConfiguration planned = planned_for(messages);
  link::ReceivedFrames received;
  const auto sent =
      decode_pair(boost::make_shared<sensor_msgs::Image>(messages.left),
                  boost::make_shared<sensor_msgs::CameraInfo>(messages.left_info),
                  boost::make_shared<sensor_msgs::Image>(messages.right),
                  boost::make_shared<sensor_msgs::CameraInfo>(messages.right_info), {});
  ASSERT_TRUE(sent);
  const auto frame = [&] { return frame_of_host_pair(received, planned, *sent, {}, {}); };
  EXPECT_EQ(frame().error().message, "board frame dropped: it has no disparity");
  EXPECT_EQ(check_raw_images(received.set).error().message,
            "board frame dropped: it has no raw left image");
  received.set.dropped = {"disparity frame 3 dropped: it did not end"};
  EXPECT_EQ(frame().error().message, received.set.dropped[0]);
  image(received.set, Stream::kDisparity) = cv::Mat1w(kSize, 5);
  EXPECT_TRUE(frame());
  planned.calibration.left.K[0] += 1;
  EXPECT_EQ(frame().error().message,
            "board frame dropped: the calibration changed while it was in flight");
}

TEST(BoardReport, AMissingBoardIsATroubleOnlyIfItIsExpected) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  BoardReport board;
  board.device.trouble = link::LinkTrouble::kNoDevice;
  board.device.trouble_text = "no USB board (FT232H, 0403:6014) found";
  board.is_expected = false;
  diagnostic_updater::DiagnosticStatusWrapper diagnostics;
  fill_diagnostics(board, diagnostics);
  EXPECT_EQ(diagnostics.level, Level::OK);
  EXPECT_EQ(diagnostics.message, "no board; the software makes the disparity");
  board.is_expected = true;
  fill_diagnostics(board, diagnostics);
  EXPECT_EQ(diagnostics.level, Level::WARN);
  EXPECT_EQ(diagnostics.message, "board: " + board.device.trouble_text);
}

TEST(Health, ARefusalHoldsUntilAFrameIsPublished) {
  Health health;
  EXPECT_FALSE(health.refusal());
  health.refused(DropCause::kUncalibrated, "left camera is uncalibrated");
  ASSERT_TRUE(health.refusal());
  EXPECT_EQ(health.refusal()->state, NodeState::kUncalibrated);
  health.refused(DropCause::kLink, {NodeState::kNoBoard, "no board"});
  EXPECT_EQ(health.refusal()->state, NodeState::kNoBoard);
  health.published({}, 1, 1);
  EXPECT_FALSE(health.refusal());
  const StereoStatus status = health.report(false);
  EXPECT_EQ(status.dropped_uncalibrated, 1U);
  EXPECT_EQ(status.dropped_link, 1U);
}

/// Keeps the lines that are logged while it lives.
class LoggedLines : public ros::console::LogAppender {
 public:
  LoggedLines() { ros::console::register_appender(this); }
  ~LoggedLines() override { ros::console::deregister_appender(this); }
  LoggedLines(const LoggedLines&) = delete;
  LoggedLines& operator=(const LoggedLines&) = delete;

  void log(ros::console::Level, const char* text, const char*, const char*, int) override {
    lines_.emplace_back(text);
  }
  const std::vector<std::string>& lines() const { return lines_; }

 private:
  std::vector<std::string> lines_;
};

TEST(Health, LogsOneLinePerCauseAndState) {
  const LoggedLines logged;
  Health health;
  // A neighbour alternates causes and numbers, and good frames come in between.
  for (int i = 0; i < 1000; ++i) {
    const std::string number = std::to_string(i);
    health.refused(DropCause::kEncoding, "left image with " + number + " bytes");
    health.refused(DropCause::kCalibration, "left camera_info K[" + number + "]");
    health.refused(DropCause::kLink, {NodeState::kNoBoard, "no board " + number});
    health.refused(DropCause::kLink, {NodeState::kBoardUnsuitable, "cannot do " + number});
    if (i % 3 == 1) health.published({}, 1, 1);
  }
  EXPECT_EQ(logged.lines(),
            (std::vector<std::string>{"left image with 0 bytes", "left camera_info K[0]",
                                      "no board 0", "cannot do 0"}));
  EXPECT_EQ(health.refusal()->text, "cannot do 999") << "the status is up to date";
}

TEST(RectificationLog, LogsOneLineOfAKind) {
  const LoggedLines logged;
  RectificationLog log;
  StereoRectification some, other;
  some.geometry.cx = 10;
  for (int i = 0; i < 1000; ++i) log.note(i % 2 == 0 ? some : other);
  ASSERT_EQ(logged.lines().size(), 2U);
  EXPECT_EQ(logged.lines()[0].rfind("new rectification: 0x0, f 0.00 px", 0), 0U);
  EXPECT_EQ(logged.lines()[1].rfind("cx of the left and right camera_info P differ by 10.000", 0),
            0U);
}

TEST(Health, KnowsWhetherAFrameHasBeenPublished) {
  Health health;
  health.published({}, 1, 1);
  EXPECT_FALSE(health.has_published()) << "a late frame: nobody has subscribed yet";
  health.set_has_subscribers(true);
  EXPECT_FALSE(health.has_published());
  health.published({}, 1, 1);
  health.set_has_subscribers(true);
  EXPECT_TRUE(health.has_published());
  health.expect_first_frame();
  EXPECT_FALSE(health.has_published());
  health.published({}, 1, 1);
  EXPECT_TRUE(health.has_published());
  health.set_has_subscribers(false);
  health.set_has_subscribers(true);
  EXPECT_FALSE(health.has_published());
}

TEST(Health, PercentilesAreNearestRanks) {
  Health health;
  for (int i = 60; i >= 1; --i) health.link_latency(i);
  EXPECT_EQ(health.report(false).board_latency_p50_ms, 30);
  EXPECT_EQ(health.report(true).board_latency_p99_ms, 60) << "of 60, one is more than 1 %";
  for (int i = 1; i <= 200; ++i) health.link_latency(i);
  EXPECT_EQ(health.report(true).board_latency_p99_ms, 198);
}

}  // namespace
}  // namespace fpga_stereo::test
