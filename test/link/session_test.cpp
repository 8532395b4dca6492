// A session with a virtual board, in simulated time.
#include "link/session.hpp"

#include <gtest/gtest.h>

#include "link/streaming_rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Session;
using link::Stream;
using State = link::LinkState;

TEST(Session, DeliversEveryStreamOfABoard) {
  Streaming rig;
  rig.pairs.resize(1);
  rig.want(7, kAll);
  ASSERT_TRUE(rig.run_until([&] { return rig.received.size() >= 20; }));
  ASSERT_TRUE(rig.streaming());
  EXPECT_EQ(rig.session.trouble_text(), "");
  const SessionRig::Setting setting = SessionRig::setting(7);
  ReferencePipeline pipeline;
  const Taps& taps = pipeline.process(rig.pairs[0].left, rig.pairs[0].right, setting.rectification,
                                      setting.parameters, 1);
  for (const link::ReceivedFrames& r : rig.received) {
    EXPECT_EQ(r.tag, 7U);
    EXPECT_TRUE(r.set.dropped.empty());
    EXPECT_TRUE(same("disparity", taps.disparity, r.set.image(Stream::kDisparity)));
    EXPECT_TRUE(same("left", taps.left, r.set.image(Stream::kRectifiedLeft)));
    EXPECT_TRUE(same("right", taps.right, r.set.image(Stream::kRectifiedRight)));
    EXPECT_TRUE(same("raw left", rig.pairs[0].left, r.set.image(Stream::kRawLeft)));
    EXPECT_TRUE(same("raw right", rig.pairs[0].right, r.set.image(Stream::kRawRight)));
  }
  for (std::size_t i = 1; i < rig.received.size(); ++i) {
    EXPECT_EQ(rig.received[i].set.frame_id, rig.received[i - 1].set.frame_id + 1);
  }
}

TEST(Session, StampsInHostTimeAcrossTheWrapOfTheBoardClock) {
  Streaming rig;
  rig.want(1);
  rig.run(15000);  // the board's clock wraps after 10 s, its frame_id after 16 frames
  ASSERT_GE(rig.good(), 700U);
  double last = 0;
  for (const link::ReceivedFrames& r : rig.received) {
    EXPECT_GT(r.stamp, last);
    last = r.stamp;
  }
  EXPECT_NEAR(last, rig.host, 0.021);
  EXPECT_NEAR(rig.session.clock().drift(), 0, 1e-5);
}

TEST(Session, StampsMidExposure) {
  Streaming rig;
  link::DesiredState wanted = rig.wanted(SessionRig::setting(1), 1, kDisparity);
  wanted.mid_exposure = std::chrono::microseconds(8000);
  rig.session.set_desired_state(wanted);
  ASSERT_TRUE(rig.run_until([&] { return rig.received.size() >= 3; }));
  EXPECT_NEAR(rig.received.back().stamp, rig.host - 0.008, 0.003);
}

TEST(Session, NeverMixesFramesOfOldAndNewSettings) {
  Streaming rig;
  std::set<std::uint64_t> tags;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    rig.want(seed);
    rig.run(20 + static_cast<int>(seed) % 90);
  }
  rig.expect_true_frames();
  for (const link::ReceivedFrames& r : rig.received) tags.insert(r.tag);
  EXPECT_GE(tags.size(), 30U);
  EXPECT_EQ(rig.received.back().tag, 40U);
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, WritesMeshesOnlyIfTheyChange) {
  Streaming rig;
  rig.want(3);
  ASSERT_TRUE(rig.run_until([&] { return rig.streaming(); }));
  EXPECT_EQ(rig.board.peek(spec::kRegMeshUploads), 1U);
  rig.want(6);  // the same min_disparity
  ASSERT_TRUE(rig.run_until([&] { return rig.session.counters().configurations == 2; }));
  EXPECT_EQ(rig.board.peek(spec::kRegMeshUploads), 1U);
  rig.want(7);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.counters().configurations == 3; }));
  EXPECT_EQ(rig.board.peek(spec::kRegMeshUploads), 2U);
}

TEST(Session, DeliversNothingThatIsNotWanted) {
  Streaming rig;
  rig.want(1, {});
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kReady; }));
  const auto packets = rig.session.line().bytes;
  rig.run(2000);
  EXPECT_LT(rig.session.line().bytes - packets, 1200U) << "four polls and four heartbeats";
  EXPECT_TRUE(rig.received.empty());
  rig.want(1, Stream::kRawLeft);
  ASSERT_TRUE(rig.run_until([&] { return !rig.received.empty(); }));
  EXPECT_TRUE(rig.received[0].set.image(Stream::kDisparity).empty());
  EXPECT_FALSE(rig.received[0].set.image(Stream::kRawLeft).empty());
}

TEST(Session, KeepsTheConfigurationOfABoard) {
  Streaming rig;
  rig.want(3, {});
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kReady; }));
  const std::uint32_t configuration = rig.board.peek(spec::kRegConfiguration);
  // A new session does not know that configuration and must leave it alone.
  rig.session = link::Session();
  link::DesiredState wanted;
  wanted.keep_configuration = true;
  wanted.tag = 3;  // the setting that the frames are compared with
  wanted.streams = kDisparity;
  rig.session.set_desired_state(wanted);
  rig.session.opened(rig.now);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 5; }));
  rig.expect_true_frames();
  EXPECT_TRUE(rig.streaming());
  EXPECT_EQ(rig.received[0].set.configuration, configuration);
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), configuration);
  EXPECT_EQ(rig.session.counters().configurations, 0U);
}

TEST(Session, DeliversRawImagesOfEveryNthPair) {
  Streaming rig;
  link::DesiredState wanted = rig.wanted(SessionRig::setting(1), 1, kAll);
  wanted.frame_interval = 2;
  wanted.raw_interval = 3;
  rig.session.set_desired_state(wanted);
  rig.run(2000);
  ASSERT_GE(rig.received.size(), 40U);
  int raw = 0;
  for (std::size_t i = 4; i < rig.received.size(); ++i) {
    EXPECT_EQ(rig.received[i].set.frame_id - rig.received[i - 1].set.frame_id, 2U);
    EXPECT_FALSE(rig.received[i].set.image(Stream::kDisparity).empty());
    const bool left = !rig.received[i].set.image(Stream::kRawLeft).empty();
    EXPECT_EQ(left, !rig.received[i].set.image(Stream::kRawRight).empty());
    raw += left ? 1 : 0;
  }
  EXPECT_NEAR(raw, static_cast<double>(rig.received.size() - 4) / 3, 1);
}

// Boards that this software does not work with.

struct Misfit {
  std::map<std::uint32_t, std::uint32_t> wrong;
  std::uint8_t version;
  std::string complaint;
};

class Misfits : public ::testing::TestWithParam<Misfit> {};

TEST_P(Misfits, AreRefusedByName) {
  auto options = SessionRig::small_board();
  options.overrides = GetParam().wrong;
  options.packet_version = GetParam().version;
  Streaming rig(options);
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  EXPECT_EQ(rig.session.trouble_text().rfind(GetParam().complaint, 0), 0U)
      << rig.session.trouble_text();
  rig.run(1500);
  EXPECT_TRUE(rig.received.empty());
  EXPECT_TRUE(rig.steps.empty());
  EXPECT_EQ(rig.notes.size(), 1U) << "reported once";
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), 0U) << "the session must write nothing";
}

INSTANTIATE_TEST_SUITE_P(
    Boards, Misfits,
    ::testing::Values(
        Misfit{
            {{spec::kRegIdentity, 0x12345678}},
            1,
            "the device is not an fpga_stereo board: IDENTITY = 0x12345678, expected 0x46535431"},
        Misfit{{{spec::kRegVersion, 0x00020003}},
               1,
               "the board's gateware has version 2.3, this software works with 0.x: flash the "
               "gateware of this release (rosrun fpga_stereo board flash)"},
        Misfit{{{spec::kRegSpecHash, 0xDEADBEEF}},
               1,
               "the board's gateware was built for specification 0xDEADBEEF, this software for 0x"},
        Misfit{
            {}, 2, "the board's packets have version 2, this software's have version 1: flash"}));

class Defects : public ::testing::TestWithParam<Misfit> {};

TEST_P(Defects, AreFoundByReadingBack) {
  auto options = SessionRig::small_board();
  options.overrides = GetParam().wrong;
  Streaming rig(options);
  rig.want(8);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  EXPECT_EQ(rig.session.trouble_text(), GetParam().complaint);
  EXPECT_TRUE(rig.received.empty());
  EXPECT_EQ(rig.board.peek(spec::kRegStreams), 0U);
}

INSTANTIATE_TEST_SUITE_P(
    Boards, Defects,
    ::testing::Values(
        Misfit{{{spec::kRegSpeckleSize, 9}},
               1,
               "the board holds 0x00000009 in register SPECKLE_SIZE instead of 0x00000008"},
        Misfit{{{spec::kRegMeshSignature, 1}},
               1,
               "the board holds 0x00000001 in register MESH_SIGNATURE instead of 0xDC0DF191"},
        Misfit{{{spec::kRegConfiguration, 0}, {spec::kRegErrors, spec::kErrorsConfig.put(1)}},
               1,
               "the board refuses its configuration: ERRORS.config"}));

TEST(Session, TriesAnotherSettingAfterARefusal) {
  auto options = SessionRig::small_board();
  options.overrides = {{spec::kRegSpeckleSize, 9}};
  Streaming rig(options);
  rig.want(8);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.state() == State::kRefused; }));
  rig.want(9);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 0; }));
  rig.expect_true_frames();
}

TEST(Session, CountsWhatTheBoardCountsWhileItIsConfigured) {
  Streaming rig;
  rig.run(1200);  // its cameras see pairs, but nobody has configured it
  ASSERT_GT(rig.board.peek(spec::kRegLongFrames), 0U);
  rig.want(1);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.board().frames_in >= 20; }));
  EXPECT_EQ(rig.session.board().long_frames, 0U);
  EXPECT_EQ(rig.session.board().cut_frames, 0U);
  const std::uint32_t before = rig.session.board().frames_in;
  EXPECT_LT(before, rig.board.peek(spec::kRegFramesIn));

  rig.session.closed();
  rig.board.reset();
  rig.run(200);
  rig.session.opened(rig.now);
  rig.want(2);
  ASSERT_TRUE(rig.run_until([&] { return rig.session.board().frames_in >= before + 20; }));
  EXPECT_EQ(rig.session.board().long_frames, 0U);
}

}  // namespace
}  // namespace fpga_stereo::test
