#include "link/watchdog.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

using link::LinkTrouble;
using link::Watchdog;
using link::WatchdogStep;
using std::chrono::milliseconds;

const link::Time kStart{std::chrono::seconds(100)};

/// Takes every step that is due in this time, during which nothing arrives.
std::vector<WatchdogStep> steps_of_silence(Watchdog& watchdog, int ms) {
  std::vector<WatchdogStep> steps;
  for (int i = 0; i < ms; ++i) {
    const link::Time now = kStart + milliseconds(i);
    if (const auto trouble = watchdog.check(now, true, 1)) {
      steps.push_back(watchdog.next_step());
      watchdog.take(steps.back(), *trouble, now);
    }
  }
  return steps;
}

TEST(Watchdog, GoesFromTheMildestStepToTheHarshest) {
  Watchdog watchdog{link::SessionOptions{}};
  watchdog.start(kStart);
  const std::vector<WatchdogStep> expected{WatchdogStep::kPurge, WatchdogStep::kRestart,
                                           WatchdogStep::kReopen, WatchdogStep::kReset,
                                           WatchdogStep::kReset};
  const auto steps = steps_of_silence(watchdog, 10000);
  ASSERT_GE(steps.size(), expected.size());
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), steps.begin()));
  EXPECT_EQ(watchdog.trouble().kind, LinkTrouble::kSilent);
  EXPECT_EQ(watchdog.steps()[0], 1U);
  watchdog.on_success();
  EXPECT_EQ(watchdog.trouble().kind, LinkTrouble::kNone);
  EXPECT_EQ(watchdog.next_step(), WatchdogStep::kPurge);
}

TEST(Watchdog, IsQuietWhilePacketsArrive) {
  Watchdog watchdog{link::SessionOptions{}};
  watchdog.start(kStart);
  for (int ms = 0; ms < 10000; ms += 500) {
    const link::Time now = kStart + milliseconds(ms);
    watchdog.on_packet(now);
    EXPECT_FALSE(watchdog.check(now + milliseconds(499), true, 1)) << ms;
  }
}

/// Polls every half second while packets, but no frames, arrive. Returns the first trouble.
LinkTrouble trouble_without_frames(Watchdog& watchdog, bool is_streaming, std::uint32_t per_poll) {
  watchdog.start(kStart);
  watchdog.on_streams_changed(kStart, 7);
  std::uint32_t frames_in = 7;
  for (int ms = 500; ms < 20000; ms += 500) {
    const link::Time now = kStart + milliseconds(ms);
    watchdog.on_packet(now);
    frames_in += per_poll;
    watchdog.on_poll(frames_in, is_streaming);
    if (const auto trouble = watchdog.check(now, is_streaming, 2)) return trouble->kind;
  }
  return LinkTrouble::kNone;
}

TEST(Watchdog, NoticesABoardThatTakesPairsButSendsNoFrames) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(trouble_without_frames(watchdog, true, 15), LinkTrouble::kStalled);
}

TEST(Watchdog, ToleratesCamerasThatDeliverNothing) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(trouble_without_frames(watchdog, true, 0), LinkTrouble::kNone);
}

TEST(Watchdog, ExpectsNoFramesWhileNothingIsStreamed) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(trouble_without_frames(watchdog, false, 15), LinkTrouble::kNone);
}

}  // namespace
}  // namespace fpga_stereo::test
