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
  watchdog.on_streams_changed(kStart, 7, false);
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

TEST(Watchdog, NoticesCamerasThatDeliverNothing) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(trouble_without_frames(watchdog, true, 0), LinkTrouble::kNoImages);
}

/// Lets 200 s pass in which packets of frames come, but no good frames. Returns when steps were
/// taken, s.
std::vector<int> steps_without_good_frames(Watchdog& watchdog, bool is_frame) {
  watchdog.start(kStart);
  watchdog.on_streams_changed(kStart, 7, false);
  std::vector<int> steps;
  for (int ms = 0; ms < 200000; ms += 100) {
    const link::Time now = kStart + milliseconds(ms);
    watchdog.on_packet(now);
    if (is_frame) watchdog.on_frame_packet(now);
    watchdog.on_poll(7, true);
    const auto trouble = watchdog.check(now, true, 1);
    if (!trouble) continue;
    watchdog.take(watchdog.next_step(), *trouble, now);
    watchdog.on_streams_changed(now, 7, false);
    steps.push_back((ms + 500) / 1000);
  }
  return steps;
}

TEST(Watchdog, WaitsEverLongerForFramesThatStayAway) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(steps_without_good_frames(watchdog, false), (std::vector<int>{3, 9, 21, 45, 94, 190}));
  watchdog.on_good_frames(kStart);
  EXPECT_EQ(watchdog.trouble().kind, LinkTrouble::kNone);
  EXPECT_EQ(steps_without_good_frames(watchdog, false).front(), 3);
}

TEST(Watchdog, IsPatientWhileAFrameArrivesSlowly) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(steps_without_good_frames(watchdog, true), (std::vector<int>{60, 120, 180}));
  EXPECT_EQ(watchdog.trouble().kind, LinkTrouble::kStalled);
}

TEST(Watchdog, WaitsForTenPeriodsOfASlowBoard) {
  Watchdog watchdog{link::SessionOptions{}};
  watchdog.start(kStart);
  watchdog.on_streams_changed(kStart, 7, false);
  const auto due = [&](int s) { return kStart + std::chrono::seconds(s); };
  for (const int s : {10, 11, 12}) watchdog.on_good_frames(due(s));
  watchdog.on_packet(due(21));
  EXPECT_FALSE(watchdog.check(due(21), true, 1));
  watchdog.on_packet(due(23));
  EXPECT_TRUE(watchdog.check(due(23), true, 1));
}

TEST(Watchdog, ExpectsFramesOfTheHostsPairsOnly) {
  Watchdog watchdog{link::SessionOptions{}};
  watchdog.start(kStart);
  watchdog.on_streams_changed(kStart, 7, true);
  const auto later = [](int s) { return kStart + std::chrono::seconds(s); };
  watchdog.on_packet(later(100));
  EXPECT_FALSE(watchdog.check(later(100), true, 1));
  watchdog.on_pair_sent(later(100));
  watchdog.on_good_frames(later(101));
  watchdog.on_packet(later(110));
  EXPECT_FALSE(watchdog.check(later(110), true, 1));
  watchdog.on_pair_sent(later(110));
  watchdog.on_packet(later(200));
  const auto trouble = watchdog.check(later(200), true, 1);
  ASSERT_TRUE(trouble);
  EXPECT_EQ(trouble->kind, LinkTrouble::kStalled);
}

TEST(Watchdog, ExpectsNoFramesWhileNothingIsStreamed) {
  Watchdog watchdog{link::SessionOptions{}};
  EXPECT_EQ(trouble_without_frames(watchdog, false, 15), LinkTrouble::kNone);
}

}  // namespace
}  // namespace fpga_stereo::test
