// What a board is told to do, for what others ask for.
#include "ros/board_plan.hpp"

#include <gtest/gtest.h>

#include "ros/rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Stream;
using link::StreamSet;

constexpr StreamSet kDisparity = Stream::kDisparity;
constexpr StreamSet kRawPair{Stream::kRawLeft, Stream::kRawRight};

link::Identity identity() {
  link::Identity made;
  made.build = {640, 64, 11, 15, CensusPattern::kSparse, 102, 81 * 61};
  made.streams = StreamSet::all();
  return made;
}

CameraTopics::Infos calibration() {
  const PairMessages pair = synthetic_pair({320, 240}, 4);
  return {pair.left_info, pair.right_info};
}

/// A plan whose board is there, for what this asks for.
struct Planned {
  explicit Planned(const BoardSettings& s = {}) : settings(s), plan(settings) {
    plan.set_calibration(calibration());
    plan.set_identity(identity());
  }
  StreamSet streams(const Demand& outputs, const CameraTopics::Demand& cameras = {}) {
    plan.set_demand(outputs, cameras);
    return plan.wanted().streams;
  }
  BoardSettings settings;
  BoardPlan plan;
};

Demand demand(bool disparity, bool left_rect = false, bool right_rect = false) {
  Demand made;
  made.disparity = disparity;
  made.left.rect = left_rect;
  made.right.rect = right_rect;
  return made;
}

TEST(BoardPlan, StreamsAreWhatSomebodyListensTo) {
  Planned p;
  EXPECT_EQ(p.plan.unable(), "");
  EXPECT_EQ(p.streams(demand(false)), StreamSet());
  EXPECT_EQ(p.streams(demand(true)), kDisparity);
  EXPECT_EQ(p.streams(demand(true, true)), kDisparity | Stream::kRectifiedLeft);
  EXPECT_EQ(p.streams(demand(false, false, true)), Stream::kRectifiedRight);
  EXPECT_EQ(p.streams(demand(true), {true, false, false}), kDisparity | Stream::kRawLeft);
  EXPECT_EQ(p.streams(demand(false), {false, false, true}), Stream::kRawLeft)
      << "a camera_info needs something that tells its stamp";
}

TEST(BoardPlan, StreamsThatTheBuildLacksAreNotAskedFor) {
  Planned p;
  const auto lacking = [&](StreamSet streams) {
    link::Identity board = identity();
    board.streams -= streams;
    p.plan.set_identity(board);
  };
  lacking({Stream::kRectifiedLeft, Stream::kRectifiedRight});
  EXPECT_EQ(p.plan.unable(), "");
  EXPECT_EQ(p.streams(demand(true, true)), kDisparity | Stream::kRawLeft) << "it is rectified here";
  EXPECT_EQ(p.streams(demand(true, false, true)), kDisparity | Stream::kRawRight);
  lacking(kRawPair | Stream::kRectifiedLeft);
  EXPECT_EQ(p.streams(demand(true, true)), kDisparity);
  lacking(kDisparity);
  EXPECT_EQ(p.plan.unable(), "this gateware does not send a disparity");
  EXPECT_EQ(p.streams(demand(true)), kRawPair);
  EXPECT_FALSE(p.plan.made(p.plan.wanted().tag)->rectification) << "the software's";
  lacking(kDisparity | Stream::kRawRight);
  EXPECT_EQ(p.plan.unable(),
            "this gateware does not send a disparity; and this gateware does not send the raw "
            "images that the software needs");
  EXPECT_EQ(p.streams(demand(true)), Stream::kRawLeft);

  BoardSettings settings;
  settings.topic_input = true;
  Planned topics(settings);
  EXPECT_EQ(topics.plan.unable(), "");
  link::Identity board = identity();
  board.streams -= Stream::kInput;
  topics.plan.set_identity(board);
  EXPECT_EQ(topics.plan.unable(), "this gateware takes no images from the host");
}

TEST(BoardPlan, ASetThatLostAnImageLacksIt) {
  BoardSettings settings;
  settings.verify = 30;
  Planned p(settings);
  link::FrameSet set;
  const auto image = [&](Stream s) -> cv::Mat& { return set.images[static_cast<int>(s)]; };
  image(Stream::kDisparity) = cv::Mat1w(4, 4);
  p.streams(demand(true, true));
  EXPECT_FALSE(p.plan.lacks(set)) << "begun before it was asked for the other one";
  set.dropped = {"rectified left frame 7 dropped: 2 of 4 rows are missing"};
  EXPECT_TRUE(p.plan.lacks(set));
  image(Stream::kRectifiedLeft) = cv::Mat1b(4, 4);
  EXPECT_FALSE(p.plan.lacks(set)) << "raw images come of some pairs only";
  p.streams(demand(true, true), {true, false, false});
  EXPECT_TRUE(p.plan.lacks(set)) << "somebody looks at them";
}

TEST(BoardPlan, TheRightImageOfAShiftedSearchIsRectifiedHere) {
  Planned p;
  Settings settings;
  settings.pipeline.min_disparity = 8;
  p.plan.set_settings(settings);
  ASSERT_EQ(p.plan.unable(), "");
  EXPECT_EQ(p.streams(demand(true, false, true)), kDisparity | Stream::kRawRight);
}

TEST(BoardPlan, VerificationNeedsRawImagesOfSomeFrames) {
  BoardSettings settings;
  settings.verify = 30;
  Planned p(settings);
  EXPECT_EQ(p.streams(demand(true)), kDisparity | kRawPair);
  EXPECT_EQ(p.plan.wanted().raw_interval, 30);
  EXPECT_EQ(p.streams(demand(false, true)), Stream::kRectifiedLeft);
  p.streams(demand(true), {true, false, false});
  EXPECT_EQ(p.plan.wanted().raw_interval, 1) << "somebody looks at them";
}

TEST(BoardPlan, WhatTheBoardCannotDoIsMadeOfRawImages) {
  Planned p;
  Settings settings;
  settings.pipeline.disparity_range = 128;
  p.plan.set_settings(settings);
  EXPECT_NE(p.plan.unable().find("disparity_range"), std::string::npos) << p.plan.unable();
  EXPECT_EQ(p.streams(demand(true)), kRawPair);
  const auto made = p.plan.made(p.plan.wanted().tag);
  ASSERT_TRUE(made);
  EXPECT_FALSE(made->rectification);
  ASSERT_TRUE(p.plan.wanted().configuration) << "its cameras still send";
  p.plan.set_settings({});
  EXPECT_EQ(p.plan.unable(), "");
  EXPECT_EQ(p.plan.wanted().streams, kDisparity);
  EXPECT_TRUE(p.plan.made(p.plan.wanted().tag)->rectification);
}

TEST(BoardPlan, ImagesTooLargeForTheBoardAreNotAskedFor) {
  Planned p;
  const PairMessages wide = synthetic_pair({800, 240}, 4);
  p.plan.set_calibration({wide.left_info, wide.right_info});
  EXPECT_NE(p.plan.unable().find("640"), std::string::npos) << p.plan.unable();
  EXPECT_FALSE(p.plan.wanted().configuration);
}

TEST(BoardPlan, PairsOfTopicsWaitForACalibration) {
  BoardSettings settings;
  settings.topic_input = true;
  BoardPlan plan(settings);
  plan.set_identity(identity());
  plan.set_demand(demand(true, false, true), {});
  EXPECT_EQ(plan.unable(), "no calibrated pair has come on its topics yet");
  EXPECT_EQ(plan.wanted().streams, StreamSet());
  plan.set_calibration(calibration());
  EXPECT_EQ(plan.unable(), "");
  EXPECT_TRUE(plan.wanted().host_input);
  EXPECT_EQ(plan.wanted().streams, kDisparity | Stream::kRectifiedRight);
  EXPECT_EQ(plan.made(plan.wanted().tag)->image_size, cv::Size(320, 240));
  plan.set_demand(demand(false, true), {true, true, true});
  EXPECT_EQ(plan.wanted().streams, kDisparity | Stream::kRectifiedLeft)
      << "raw images are on topics already; what came back is known by its disparity";
}

TEST(BoardPlan, ACalibrationHoldsUntilBothSidesOfTheNextAgree) {
  Planned p;
  const std::uint64_t tag = p.plan.wanted().tag;
  CameraTopics::Infos next = calibration();
  EXPECT_FALSE(*p.plan.offer_calibration(next)) << "it is the same";
  next.left.P[0] = next.left.P[5] = 250;
  const auto half = p.plan.offer_calibration(next);
  ASSERT_FALSE(half);
  EXPECT_EQ(p.plan.wanted().tag, tag);
  next.right.P[3] *= 250 / next.right.P[0];
  next.right.P[0] = next.right.P[5] = 250;
  const auto whole = p.plan.offer_calibration(next);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_TRUE(*whole);
  EXPECT_GT(p.plan.wanted().tag, tag);
  EXPECT_EQ(p.plan.made(p.plan.wanted().tag)->infos.left.P[0], 250);
  EXPECT_EQ(p.plan.made(tag)->infos.left.P[0], calibration().left.P[0]) << "frames under way";
}

TEST(BoardPlan, ForgetsConfigurationsOfLongAgo) {
  Planned p;
  const std::uint64_t first = p.plan.wanted().tag;
  for (int i = 1; i < 8; ++i) p.plan.set_settings({});
  EXPECT_TRUE(p.plan.made(first));
  p.plan.set_settings({});
  EXPECT_FALSE(p.plan.made(first));
}

}  // namespace
}  // namespace fpga_stereo::test
