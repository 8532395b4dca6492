// Which messages are late, and which show that time itself has moved back.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "ros/replay_clock.hpp"
#include "ros/rewind_detector.hpp"
#include "ros/stamp_gate.hpp"

namespace fpga_stereo::test {
namespace {

using Stamps = std::vector<ros::Time>;

/// Returns `count` stamps from `start` on, `period` s apart.
Stamps stamps_from(double start, int count, double period = 0.1) {
  Stamps stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(ros::Time(start) + ros::Duration(period * i));
  return stamps;
}

/// Returns the indices of the stamps that show that time has moved back.
std::vector<std::size_t> rewinds(const Stamps& stamps) {
  RewindDetector detector;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (detector.note(stamps[i], std::nullopt)) found.push_back(i);
  }
  return found;
}

Stamps operator+(Stamps first, const Stamps& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

using Indices = std::vector<std::size_t>;

TEST(RewindDetector, FindsEveryLoopOfABag) {
  for (const int pairs : {3, 5, 12, 20, 120, 1000}) {
    SCOPED_TRACE(pairs);
    const Stamps bag = stamps_from(1000, pairs);
    const auto n = static_cast<std::size_t>(pairs);
    EXPECT_EQ(rewinds(bag + bag + bag), (Indices{n + 1, 2 * n + 1}));
  }
}

TEST(RewindDetector, FindsAClockThatWasSetBack) {
  EXPECT_EQ(rewinds(stamps_from(5000, 3) + stamps_from(1400, 100)), (Indices{4}));
  EXPECT_EQ(rewinds(stamps_from(5000, 300) + stamps_from(5020, 100)), (Indices{301}))
      << "by less than 30 s";
}

TEST(RewindDetector, RecoversFromAStampInTheFuture) {
  EXPECT_EQ(rewinds(stamps_from(1000, 3) + stamps_from(90000, 1) + stamps_from(1000.3, 100)),
            (Indices{5}));
}

TEST(RewindDetector, IgnoresLateMessages) {
  EXPECT_EQ(rewinds(stamps_from(1000, 50) + stamps_from(940, 1) + stamps_from(1005, 50)),
            Indices{});
  EXPECT_EQ(rewinds(stamps_from(1000, 50) + stamps_from(1004.8, 1) + stamps_from(1005, 50)),
            Indices{});
}

TEST(RewindDetector, IgnoresReordering) {
  std::mt19937 random(1);
  for (const double period : {0.01, 0.1, 1.0}) {
    for (int seed = 0; seed < 1000; ++seed) {
      Stamps stamps = stamps_from(1000, 141, period);
      for (std::size_t at = 0; at < stamps.size(); at += 10) {
        const auto begin = stamps.begin() + static_cast<std::ptrdiff_t>(at);
        const auto end =
            stamps.begin() + std::min<std::ptrdiff_t>(141, static_cast<std::ptrdiff_t>(at) + 10);
        std::shuffle(begin, end, random);
      }
      ASSERT_EQ(rewinds(stamps), Indices{}) << "period " << period << ", seed " << seed;
    }
  }
}

TEST(RewindDetector, IgnoresStampsThatDoNotMove) {
  EXPECT_EQ(rewinds(Stamps(100, ros::Time(1000))), Indices{});
  EXPECT_EQ(rewinds(stamps_from(1000, 50) + Stamps(100, ros::Time(0)) + stamps_from(1005, 50)),
            Indices{});
  Stamps twice;
  for (const ros::Time& stamp : stamps_from(1000, 50)) twice = twice + Stamps(2, stamp);
  EXPECT_EQ(rewinds(twice), Indices{});
}

TEST(RewindDetector, FollowsTheSimulatedClockAtOnce) {
  RewindDetector detector;
  EXPECT_EQ(detector.note(ros::Time(1000), ros::Time(1000.5)), std::nullopt);
  EXPECT_EQ(detector.note(ros::Time(1001), ros::Time(1001.5)), std::nullopt);
  EXPECT_EQ(detector.note(ros::Time(1000), ros::Time(1000.25)),
            "simulated time moved back from 1001.500 to 1000.250 s");
  EXPECT_EQ(detector.note(ros::Time(1001), ros::Time(1001)), std::nullopt) << "only once";
  EXPECT_EQ(detector.note(ros::Time(1002), std::nullopt), std::nullopt);
}

TEST(RewindDetector, SaysWhatMovedBack) {
  RewindDetector detector;
  EXPECT_EQ(detector.note(ros::Time(1000), std::nullopt), std::nullopt);
  EXPECT_EQ(detector.note(ros::Time(900), std::nullopt), std::nullopt);
  EXPECT_EQ(detector.note(ros::Time(900.5), std::nullopt),
            "the stamps moved back from 1000.000 to 900.500 s");
}

TEST(ReplayClock, KeepsTheRecordedIntervals) {
  ReplayClock clock;
  const ros::Time start(1000, 500);
  EXPECT_EQ(*clock.stamp(7'000'000, 2, start), start);
  EXPECT_EQ(*clock.stamp(7'000'000, 2, ros::Time(2000)), start);
  EXPECT_EQ(*clock.stamp(8'000'000, 2, ros::Time(2000)), ros::Time(1000, 500'000'500));
  EXPECT_EQ(*clock.stamp(8'000'010, 2, ros::Time(2000)), ros::Time(1000, 500'005'500));
}

TEST(ReplayClock, FollowsTheTimeIfThereIsNoSpeed) {
  ReplayClock clock;
  EXPECT_EQ(*clock.stamp(7'000'000, 0, ros::Time(1000)), ros::Time(1000));
  EXPECT_EQ(*clock.stamp(9'000'000, 0, ros::Time(1001)), ros::Time(1001));
  EXPECT_EQ(*clock.stamp(5'000'000, 0, ros::Time(500)), ros::Time(500));
}

TEST(ReplayClock, BeginsAnewWithABoardThatWasReset) {
  ReplayClock clock;
  EXPECT_EQ(*clock.stamp(10'000'000'000, 1, ros::Time(100)), ros::Time(100));
  EXPECT_EQ(*clock.stamp(10'001'000'000, 1, ros::Time(101)), ros::Time(101));
  EXPECT_EQ(*clock.stamp(20, 1, ros::Time(102)), ros::Time(102)) << "not 10000 s before 100 s";
  EXPECT_EQ(*clock.stamp(1'000'020, 1, ros::Time(103)), ros::Time(103));
}

TEST(ReplayClock, RefusesStampsThatRosCannotRepresent) {
  for (const double speed : {1e-9, 0.2, 1.0, 1000.0}) {
    ReplayClock clock;
    EXPECT_EQ(*clock.stamp(0, speed, ros::Time(1000)), ros::Time(1000));
    EXPECT_FALSE(clock.stamp(~std::uint64_t{0}, speed, ros::Time(1000))) << speed;
  }
  ReplayClock clock;
  EXPECT_EQ(*clock.stamp(0, 1, ros::Time(1000)), ros::Time(1000));
  EXPECT_EQ(clock.stamp(3'000'000'000'000'000, 1, ros::Time(1000))->sec, 3'000'001'000U);
  const auto refused = clock.stamp(5'000'000'000'000'000, 1, ros::Time(1000));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "its board time is 5000000000 s after the first one: allowed are stamps of up to "
            "4294967295 s");
}

TEST(StampGate, AcceptsStampsThatRise) {
  StampGate gate;
  EXPECT_EQ(*gate.accept(ros::Time(10, 0)), 1U);
  EXPECT_EQ(*gate.accept(ros::Time(10, 1)), 2U);
  EXPECT_EQ(*gate.accept(ros::Time(12)), 3U);
  for (const double late : {12.0, 11.0, 11.1, 11.2, 11.3, 11.4, 1.0, 1.1, 1.2, 1.3}) {
    EXPECT_FALSE(gate.accept(ros::Time(late))) << late;
  }
  EXPECT_EQ(*gate.accept(ros::Time(12.5)), 4U);
  const auto refused = gate.accept(ros::Time(12.25));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message,
            "its stamp 12.250 is not later than 12.500, the stamp of the previous pair");
  EXPECT_FALSE(gate.accept(ros::Time(0)));
}

TEST(StampGate, AcceptsAnyStampAfterARestart) {
  StampGate gate;
  EXPECT_EQ(*gate.accept(ros::Time(10)), 1U);
  gate.restart("a test moved back");
  EXPECT_FALSE(gate.accept(ros::Time(0)));
  EXPECT_EQ(*gate.accept(ros::Time(2)), 2U) << "numbers go on";
  EXPECT_FALSE(gate.accept(ros::Time(2)));
  EXPECT_EQ(*gate.accept(ros::Time(3)), 3U);
}

}  // namespace
}  // namespace fpga_stereo::test
