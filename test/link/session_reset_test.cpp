// A session whose board is reset, or applies a configuration late or twice.
#include <gtest/gtest.h>

#include <algorithm>

#include "link/session.hpp"
#include "link/streaming_rig.hpp"

namespace fpga_stereo::test {
namespace {

using link::Session;

/// Returns true if the bytes contain the request that applies a configuration.
bool applies(const SessionRig::Bytes& bytes) {
  const auto apply = link::write_request({{spec::kRegControl, spec::kControlApply.put(1)}}).payload;
  return std::search(bytes.begin(), bytes.end(), apply.begin(), apply.end()) != bytes.end();
}

/// A board whose registers hold a valid image size after a reset.
sim::SoftwareBoard::Options board_that_starts_sized() {
  auto options = SessionRig::small_board();
  options.overrides = {{spec::kRegWidth, 64}, {spec::kRegHeight, 24}};
  return options;
}

// After a reset the board's clock shows less than before, or, if the last reset was recent, more.
constexpr std::chrono::seconds kClocks[] = {std::chrono::seconds(0), std::chrono::seconds(60)};

TEST(Session, ConfiguresABoardThatWasResetAgain) {
  Streaming rig;
  rig.want(4);
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(rig.run_until([&] { return rig.good() > 10; }));
    rig.run(i * 7);
    rig.board.reset();
  }
  const std::size_t before = rig.good();
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > before + 10; }));
  rig.expect_true_frames();
  for (const link::ReceivedFrames& r : rig.received) EXPECT_NEAR(r.stamp, r.arrived, 0.005);
  EXPECT_TRUE(rig.noted("the board was reset"));
  EXPECT_TRUE(rig.steps.empty());
}

TEST(Session, NoticesAResetByTheClockAlone) {
  Streaming rig;
  link::DesiredState nothing;
  nothing.keep_configuration = true;
  rig.session.set_desired_state(nothing);
  rig.run(1000);
  ASSERT_EQ(rig.session.state(), link::LinkState::kReady);
  rig.board.reset();
  rig.run(1000);
  EXPECT_TRUE(rig.noted("the board was reset"));
  EXPECT_EQ(rig.session.state(), link::LinkState::kReady);
}

TEST(Session, NoticesAResetBeforeTheApply) {
  for (const auto clock : kClocks) {
    Streaming rig(board_that_starts_sized());
    int resets = 1;
    rig.to_board = [&](SessionRig::Bytes& bytes) {
      if (!applies(bytes) || resets-- <= 0) return;
      rig.board.reset();
      rig.board.run(clock);
    };
    rig.want(4);
    ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; })) << rig.session.trouble_text();
    rig.expect_true_frames();
    EXPECT_LE(resets, 0);
    EXPECT_EQ(rig.session.counters().configurations, 1U);
  }
}

TEST(Session, NoticesAResetAfterTheApply) {
  for (const auto clock : kClocks) {
    Streaming rig(board_that_starts_sized());
    rig.want(4, kAll);
    ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
    bool applied = false;
    rig.to_board = [&](SessionRig::Bytes& bytes) { applied = applies(bytes); };
    rig.to_host = [&](SessionRig::Bytes&) {
      if (!std::exchange(applied, false)) return;
      rig.to_board = nullptr;
      rig.board.reset();
      rig.board.run(clock);
    };
    rig.want(5);
    ASSERT_TRUE(rig.run_until([&] { return rig.received.back().tag == 5 && rig.good() > 10; }))
        << rig.session.trouble_text();
    rig.expect_true_frames();
    EXPECT_EQ(rig.session.counters().unknown_configurations, 0U);
    EXPECT_TRUE(rig.steps.empty());
  }
}

TEST(Session, ToleratesAnApplyThatTakesEffectTwice) {
  Streaming rig;
  rig.want(4);
  ASSERT_TRUE(rig.run_until([&] { return rig.good() > 3; }));
  int applied = 0;
  bool lose = false;
  rig.to_board = [&](SessionRig::Bytes& bytes) {
    if (!applies(bytes)) return;
    lose = ++applied == 1;
    rig.board.hold_frame(applied == 2);
  };
  rig.to_host = [&](SessionRig::Bytes& bytes) {
    if (std::exchange(lose, false)) bytes.clear();
  };
  rig.want(5);
  ASSERT_TRUE(rig.run_until([&] { return applied == 2; }));
  rig.run(30);
  EXPECT_EQ(rig.session.counters().configurations, 1U) << "one apply is pending";
  rig.board.hold_frame(false);
  rig.run(2000);
  EXPECT_EQ(rig.session.counters().configurations, 2U);
  EXPECT_EQ(rig.board.peek(spec::kRegConfiguration), 3U);
  EXPECT_FALSE(rig.noted("the board was reset"));
  EXPECT_EQ(rig.received.back().tag, 5U);
  rig.expect_true_frames();
}

}  // namespace
}  // namespace fpga_stereo::test
