// What a board sends is checked before it is used; and what is told about a board.
#include "ros/board_frames.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ros/board_report.hpp"
#include "ros/health.hpp"
#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Stream;

const cv::Size kSize(64, 48);

cv::Mat& image(link::FrameSet& set, Stream stream) {
  return set.images[static_cast<std::size_t>(stream)];
}

BoardPlan::Made made_of(const PairMessages& pair) {
  BoardPlan::Made made;
  made.infos = {pair.left_info, pair.right_info};
  made.image_size = kSize;
  Rectifier rectifier;
  made.rectification = *rectifier(pair.left_info, pair.right_info, 0);
  return made;
}

TEST(BoardFrames, StampsThatNoTimeCanHoldAreRefused) {
  ASSERT_TRUE(to_stamp(1.5));
  EXPECT_EQ(*to_stamp(1.5), ros::Time(1, 500000000));
  for (const double bad :
       {0.0, -1.0, 4294967295.0, 1.8e13, std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(to_stamp(bad)) << bad;
  }
  EXPECT_EQ(to_stamp(-1).error().message,
            "frame of the board dropped: its stamp is -1.000000 s: allowed 0 to 4294967295");
}

TEST(BoardFrames, ImagesOfAnotherSizeAreRefused) {
  link::FrameSet set;
  EXPECT_TRUE(check_sizes(set, kSize));
  image(set, Stream::kDisparity) = cv::Mat1w(kSize);
  image(set, Stream::kRawLeft) = cv::Mat1b(kSize);
  EXPECT_TRUE(check_sizes(set, kSize));
  image(set, Stream::kRawLeft) = cv::Mat1b(32, 64);
  const Status wrong = check_sizes(set, kSize);
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().message,
            "frame of the board dropped: its raw left image is 64x32 instead of 64x48");
}

TEST(BoardFrames, AShiftedRightImageIsNotPassedOn) {
  BoardPlan::Made made = made_of(synthetic_pair(kSize, 4));
  link::ReceivedFrames received;
  image(received.set, Stream::kRectifiedRight) = cv::Mat1b(kSize, 7);
  EXPECT_FALSE(frame_of_cameras(received, made, {}, {}).right.rect.empty());
  made.settings.pipeline.min_disparity = 8;
  EXPECT_TRUE(frame_of_cameras(received, made, {}, {}).right.rect.empty());
}

TEST(BoardFrames, WhatTheBoardDoesNotSendIsRectifiedHere) {
  const PairMessages pair = synthetic_pair(kSize, 4, true);
  const BoardPlan::Made made = made_of(pair);
  link::ReceivedFrames received;
  image(received.set, Stream::kRawLeft) = cv::Mat1b(kSize, 100);
  Demand demand;
  demand.left.rect = true;
  const StereoFrame frame = frame_of_cameras(received, made, demand, {});
  cv::Mat expected;
  rectify_image(cv::Mat1b(kSize, 100), made.rectification->left.mesh, 1, expected);
  ASSERT_EQ(frame.left.rect.size(), kSize);
  EXPECT_EQ(cv::norm(frame.left.rect, expected, cv::NORM_L1), 0);
  EXPECT_TRUE(frame.disparity.empty());
}

TEST(BoardFrames, PairsThatLackSomethingAreRefusedByName) {
  const PairMessages pair = synthetic_pair(kSize, 4);
  BoardPlan::Made made = made_of(pair);
  link::ReceivedFrames received;
  const InputPair sent{boost::make_shared<sensor_msgs::Image>(pair.left),
                       boost::make_shared<sensor_msgs::Image>(pair.right),
                       boost::make_shared<sensor_msgs::CameraInfo>(pair.left_info),
                       boost::make_shared<sensor_msgs::CameraInfo>(pair.right_info)};
  EXPECT_EQ(frame_of_pair(received, made, sent, {}).error().message,
            "frame of the board dropped: it has no disparity");
  EXPECT_EQ(raw_pair(received.set, made, {}).error().message,
            "frame of the board dropped: it has no raw pair");
  received.set.dropped = {"disparity frame 3 dropped: it did not end"};
  EXPECT_EQ(frame_of_pair(received, made, sent, {}).error().message, received.set.dropped[0]);
  image(received.set, Stream::kDisparity) = cv::Mat1w(kSize, 5);
  EXPECT_TRUE(frame_of_pair(received, made, sent, {}));
  made.infos.left.K[0] += 1;
  EXPECT_EQ(frame_of_pair(received, made, sent, {}).error().message,
            "frame of the board dropped: the calibration changed under way");
}

TEST(BoardReport, NoBoardIsNoTroubleWhereNoneIsExpected) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  link::Device::Snapshot none;
  none.complaint = "no USB board (FT232H, 0403:6014): none is there";
  diagnostic_updater::DiagnosticStatusWrapper report;
  report_board(none, {}, "", false, report);
  EXPECT_EQ(report.level, Level::OK);
  EXPECT_EQ(report.message, "no board; software");
  report_board(none, {}, "", true, report);
  EXPECT_EQ(report.level, Level::WARN);
  EXPECT_EQ(report.message, none.complaint);
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
