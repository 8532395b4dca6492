// BoardPlan: from build, parameters, calibration and demand to configuration and streams.
#include "fpga_stereo/link/board_plan.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

using link::BoardAbility;
using link::BoardDemand;
using link::BoardPlan;
using link::Stream;
using link::StreamSet;

constexpr StreamSet kDisparity = Stream::kDisparity;
constexpr StreamSet kRawStreams{Stream::kRawLeft, Stream::kRawRight};

link::Identity identity() {
  link::Identity board;
  board.build = {640, 64, 11, 15, CensusPattern::kSparse, 102, 81 * 61};
  board.streams = StreamSet::all();
  return board;
}

StereoCalibration calibration(cv::Size size = {320, 240}) {
  const double cx = size.width / 2.0, cy = size.height / 2.0;
  CameraCalibration left;
  left.width = size.width;
  left.height = size.height;
  left.distortion_model = "plumb_bob";
  left.K = {300, 0, cx, 0, 300, cy, 0, 0, 1};
  left.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  left.P = {300, 0, cx, 0, 0, 300, cy, 0, 0, 0, 1, 0};
  CameraCalibration right = left;
  right.P[3] = -30;
  return {left, right};
}

BoardPlan::Options host_input() {
  BoardPlan::Options options;
  options.host_input = true;
  return options;
}

BoardPlan::Options verify_interval(int interval) {
  BoardPlan::Options options;
  options.verify_interval = interval;
  return options;
}

/// A plan with a connected, calibrated board.
struct Planned {
  explicit Planned(const BoardPlan::Options& options = {}) : plan(options) {
    plan.set_calibration(calibration());
    plan.set_identity(identity());
  }
  StreamSet streams(const BoardDemand& demand) {
    plan.set_demand(demand);
    return plan.desired_state().streams;
  }
  BoardPlan plan;
};

BoardDemand demand(bool disparity, bool rectified_left = false, bool rectified_right = false) {
  BoardDemand wanted;
  wanted.disparity = disparity;
  wanted.rectified_left = rectified_left;
  wanted.rectified_right = rectified_right;
  return wanted;
}

BoardDemand with_raw_left(BoardDemand wanted) {
  wanted.raw_left = true;
  return wanted;
}

BoardDemand only_stamps() {
  BoardDemand wanted;
  wanted.stamps = true;
  return wanted;
}

TEST(BoardPlan, SendsOnlyStreamsInDemand) {
  Planned p;
  EXPECT_EQ(p.plan.ability(), BoardAbility::kMakesDisparity);
  EXPECT_EQ(p.plan.limitation(), "");
  EXPECT_EQ(p.streams(demand(false)), StreamSet());
  EXPECT_EQ(p.streams(demand(true)), kDisparity);
  EXPECT_EQ(p.streams(demand(true, true)), kDisparity | Stream::kRectifiedLeft);
  EXPECT_EQ(p.streams(demand(false, false, true)), Stream::kRectifiedRight);
  EXPECT_EQ(p.streams(with_raw_left(demand(true))), kDisparity | Stream::kRawLeft);
  EXPECT_EQ(p.streams(only_stamps()), Stream::kRawLeft)
      << "a camera_info needs an image that tells its stamp";
}

TEST(BoardPlan, HasNoAbilityWithoutABoard) {
  Planned p;
  p.plan.set_identity(std::nullopt);
  EXPECT_FALSE(p.plan.has_board());
  EXPECT_FALSE(p.plan.makes_disparity());
  EXPECT_EQ(p.plan.ability(), BoardAbility::kNoBoard);
  p.plan.set_identity(identity());
  EXPECT_TRUE(p.plan.makes_disparity());
}

TEST(BoardPlan, DoesNotRequestStreamsThatTheBuildLacks) {
  Planned p;
  const auto remove = [&](StreamSet streams) {
    link::Identity board = identity();
    board.streams -= streams;
    p.plan.set_identity(board);
  };
  remove({Stream::kRectifiedLeft, Stream::kRectifiedRight});
  EXPECT_EQ(p.plan.limitation(), "");
  EXPECT_EQ(p.streams(demand(true, true)), kDisparity | Stream::kRawLeft)
      << "the host rectifies it";
  EXPECT_EQ(p.streams(demand(true, false, true)), kDisparity | Stream::kRawRight);
  remove(Stream::kRectifiedLeft | kRawStreams);
  EXPECT_EQ(p.streams(demand(true, true)), kDisparity);
  remove(kDisparity);
  EXPECT_EQ(p.plan.ability(), BoardAbility::kSendsRawImages);
  EXPECT_EQ(p.plan.limitation(), "this gateware does not send a disparity");
  EXPECT_EQ(p.streams(demand(true)), kRawStreams);
  EXPECT_FALSE(p.plan.configuration(p.plan.desired_state().tag)->rectification)
      << "the software computes the disparity";
  remove(kDisparity | Stream::kRawRight);
  EXPECT_EQ(p.plan.limitation(),
            "this gateware does not send a disparity; the software cannot compute it either, "
            "because this gateware does not send both raw images");
  EXPECT_EQ(p.streams(demand(true)), Stream::kRawLeft);

  Planned topics(host_input());
  EXPECT_EQ(topics.plan.limitation(), "");
  link::Identity board = identity();
  board.streams -= Stream::kInput;
  topics.plan.set_identity(board);
  EXPECT_EQ(topics.plan.limitation(), "this gateware does not take images from the host");
}

TEST(BoardPlan, ASetWithADroppedImageInDemandIsIncomplete) {
  Planned p(verify_interval(30));
  link::FrameSet set;
  const auto image = [&](Stream s) -> cv::Mat& { return set.images[static_cast<int>(s)]; };
  image(Stream::kDisparity) = cv::Mat1w(4, 4);
  p.streams(demand(true, true));
  EXPECT_FALSE(p.plan.is_incomplete(set)) << "it began before the demand for the other image";
  set.dropped = {"rectified left frame 7 dropped: 2 of 4 rows are missing"};
  EXPECT_TRUE(p.plan.is_incomplete(set));
  image(Stream::kRectifiedLeft) = cv::Mat1b(4, 4);
  EXPECT_FALSE(p.plan.is_incomplete(set)) << "raw images come with some pairs only";
  p.streams(with_raw_left(demand(true, true)));
  EXPECT_TRUE(p.plan.is_incomplete(set)) << "a subscriber wants them";
}

TEST(BoardPlan, RequestsTheRawRightImageIfTheSearchIsShifted) {
  Planned p;
  Parameters parameters = window_parameters();
  parameters.min_disparity = 8;
  p.plan.set_parameters(parameters);
  ASSERT_EQ(p.plan.limitation(), "");
  EXPECT_EQ(p.streams(demand(true, false, true)), kDisparity | Stream::kRawRight);
}

TEST(BoardPlan, VerificationRequestsRawImagesOfSomePairs) {
  Planned p(verify_interval(30));
  EXPECT_EQ(p.streams(demand(true)), kDisparity | kRawStreams);
  EXPECT_EQ(p.plan.desired_state().raw_interval, 30);
  EXPECT_EQ(p.streams(demand(false, true)), Stream::kRectifiedLeft);
  p.streams(with_raw_left(demand(true)));
  EXPECT_EQ(p.plan.desired_state().raw_interval, 1) << "a subscriber wants them";
}

TEST(BoardPlan, RequestsRawImagesIfTheBuildCannotMakeTheDisparity) {
  Planned p;
  Parameters parameters = window_parameters();
  parameters.disparity_range = 128;
  p.plan.set_parameters(parameters);
  EXPECT_EQ(p.plan.ability(), BoardAbility::kSendsRawImages);
  EXPECT_NE(p.plan.limitation().find("disparity_range"), std::string::npos) << p.plan.limitation();
  EXPECT_EQ(p.streams(demand(true)), kRawStreams);
  const auto planned = p.plan.configuration(p.plan.desired_state().tag);
  ASSERT_TRUE(planned);
  EXPECT_FALSE(planned->rectification);
  ASSERT_TRUE(p.plan.desired_state().configuration) << "its cameras still send";
  p.plan.set_parameters(window_parameters());
  EXPECT_EQ(p.plan.limitation(), "");
  EXPECT_EQ(p.plan.desired_state().streams, kDisparity);
  EXPECT_TRUE(p.plan.configuration(p.plan.desired_state().tag)->rectification);
}

TEST(BoardPlan, TheBuildDecidesAboutAnAlgorithmThatIsNotChosen) {
  Planned p;
  p.plan.set_parameters({}, false /* is_algorithm_chosen */);
  EXPECT_EQ(p.plan.limitation(), "");
  EXPECT_EQ(p.plan.parameters().stereo_algorithm, StereoAlgorithm::kWindow);
  EXPECT_EQ(p.plan.configuration(p.plan.desired_state().tag)->parameters.stereo_algorithm,
            StereoAlgorithm::kWindow);

  Parameters small;  // without effect on window matching
  small.sgm_build = SgmBuild::kSmall;
  p.plan.set_parameters(small, false);
  EXPECT_EQ(p.plan.limitation(), "");

  p.plan.set_identity(std::nullopt);
  EXPECT_EQ(p.plan.parameters().stereo_algorithm, StereoAlgorithm::kSgm) << "no board decides";
  p.plan.set_identity(identity());
  EXPECT_EQ(p.plan.parameters().stereo_algorithm, StereoAlgorithm::kWindow);

  Parameters wide;
  wide.disparity_range = 128;
  p.plan.set_parameters(wide, false);
  EXPECT_EQ(p.plan.limitation(), "disparity_range = 128: this gateware is built for 64 only");
  EXPECT_EQ(p.plan.parameters().stereo_algorithm, StereoAlgorithm::kWindow)
      << "the software computes the board's pairs as the board would";
}

TEST(BoardPlan, AChosenAlgorithmOrDenseCanMakeABoardUnsuitable) {
  Planned p;
  p.plan.set_parameters({}, true /* is_algorithm_chosen */);
  EXPECT_EQ(p.plan.ability(), BoardAbility::kSendsRawImages);
  EXPECT_EQ(p.plan.limitation(), "stereo_algorithm = sgm: this gateware is built for window only");
  EXPECT_EQ(p.plan.parameters().stereo_algorithm, StereoAlgorithm::kSgm);
  EXPECT_EQ(p.streams(demand(true)), kRawStreams) << "the software computes the disparity";
  p.plan.set_parameters(window_parameters(), true);
  EXPECT_EQ(p.plan.limitation(), "");

  Parameters dense;
  dense.dense = true;
  p.plan.set_parameters(dense, false);
  EXPECT_EQ(p.plan.limitation(), "dense = true: this gateware is built for false only");
  EXPECT_EQ(p.plan.parameters().stereo_algorithm, StereoAlgorithm::kWindow);
  EXPECT_TRUE(p.plan.parameters().dense);
}

TEST(BoardPlan, HasNoConfigurationForImagesTooLargeForTheBuild) {
  Planned p;
  p.plan.set_calibration(calibration({800, 240}));
  EXPECT_EQ(p.plan.ability(), BoardAbility::kNothing);
  EXPECT_NE(p.plan.limitation().find("640"), std::string::npos) << p.plan.limitation();
  EXPECT_FALSE(p.plan.desired_state().configuration);
}

TEST(BoardPlan, PairsFromTheHostNeedACalibrationFirst) {
  BoardPlan plan(host_input());
  plan.set_identity(identity());
  plan.set_demand(demand(true, false, true));
  EXPECT_EQ(plan.ability(), BoardAbility::kNeedsCalibration);
  EXPECT_EQ(plan.limitation(), "no pair with a calibration has arrived yet");
  EXPECT_EQ(plan.desired_state().streams, StreamSet());
  plan.set_calibration(calibration());
  EXPECT_EQ(plan.limitation(), "");
  EXPECT_TRUE(plan.desired_state().host_input);
  EXPECT_EQ(plan.desired_state().streams, kDisparity | Stream::kRectifiedRight);
  EXPECT_EQ(plan.configuration(plan.desired_state().tag)->image_size, cv::Size(320, 240));
  BoardDemand everything = with_raw_left(demand(false, true));
  everything.raw_right = everything.stamps = true;
  plan.set_demand(everything);
  EXPECT_EQ(plan.desired_state().streams, kDisparity | Stream::kRectifiedLeft)
      << "the host has the raw images; the disparity tells that a pair has come back";
}

TEST(BoardPlan, KeepsACalibrationUntilBothSidesOfTheNextAgree) {
  Planned p;
  const std::uint64_t tag = p.plan.desired_state().tag;
  StereoCalibration next = calibration();
  EXPECT_FALSE(*p.plan.offer_calibration(next)) << "it is the same";
  next.left.P[0] = next.left.P[5] = 250;
  const auto half = p.plan.offer_calibration(next);
  ASSERT_FALSE(half);
  EXPECT_EQ(p.plan.desired_state().tag, tag);
  next.right.P[3] *= 250 / next.right.P[0];
  next.right.P[0] = next.right.P[5] = 250;
  const auto whole = p.plan.offer_calibration(next);
  ASSERT_TRUE(whole) << whole.error().message;
  EXPECT_TRUE(*whole);
  EXPECT_GT(p.plan.desired_state().tag, tag);
  EXPECT_EQ(p.plan.configuration(p.plan.desired_state().tag)->calibration.left.P[0], 250);
  EXPECT_EQ(p.plan.configuration(tag)->calibration.left.P[0], calibration().left.P[0])
      << "frames in flight need the old one";
}

TEST(BoardPlan, ForgetsOldConfigurations) {
  Planned p;
  const std::uint64_t first = p.plan.desired_state().tag;
  for (int i = 1; i < 8; ++i) p.plan.set_parameters({});
  EXPECT_TRUE(p.plan.configuration(first));
  p.plan.set_parameters({});
  EXPECT_FALSE(p.plan.configuration(first));
}

}  // namespace
}  // namespace fpga_stereo::test
