#include "link/time_sync.hpp"

#include <gtest/gtest.h>

#include <random>

namespace fpga_stereo::test {
namespace {

using link::TimeSync;

/// A board clock that runs too fast by `drift` and showed `board` us when the host's showed `host`
/// s.
struct Clocks {
  double drift = 0;
  std::uint64_t board = 1000;
  double host = 1e9;

  std::uint64_t board_at(double t) const {
    return board + static_cast<std::uint64_t>((t - host) * (1 + drift) * 1e6 + 0.5);
  }
};

TEST(TimeSync, KnowsNothingWithoutASample) {
  TimeSync sync;
  EXPECT_FALSE(sync.to_host(5));
}

TEST(TimeSync, TakesTheMiddleOfTheRoundTrip) {
  TimeSync sync;
  EXPECT_TRUE(sync.add(10.000, 500, 10.004));
  ASSERT_TRUE(sync.to_host(500));
  EXPECT_NEAR(*sync.to_host(500), 10.002, 1e-9);
  EXPECT_NEAR(*sync.to_host(1500), 10.003, 1e-9);
  EXPECT_NEAR(sync.uncertainty(), 0.002, 1e-9);
}

TEST(TimeSync, IgnoresLongRoundTrips) {
  TimeSync sync;
  EXPECT_TRUE(sync.add(10, 500, 10.009));
  EXPECT_FALSE(sync.add(11, 1000500, 11.011));
  EXPECT_FALSE(sync.add(12, 2000500, 11.999)) << "ended before it began";
  EXPECT_EQ(sync.samples(), 1U);
}

TEST(TimeSync, FollowsADriftingClockThroughItsWrap) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> way(0.0001, 0.002);
  for (const double drift : {-80e-6, 0.0, 75e-6}) {
    Clocks clocks{drift, 0 - std::uint64_t{20000000}, 1.6e9};
    TimeSync sync;
    for (double t = clocks.host; t < clocks.host + 120; t += 0.5) {
      const double out = way(random), back = way(random);
      ASSERT_TRUE(sync.add(t - out, clocks.board_at(t), t + back));
      if (t < clocks.host + 10) continue;
      ASSERT_NEAR(*sync.to_host(clocks.board_at(t + 0.4)), t + 0.4, 0.001) << t - clocks.host;
    }
    EXPECT_NEAR(sync.drift(), drift, 10e-6);
  }
}

TEST(TimeSync, NeverStepsBack) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> way(0.0001, 0.0049);
  Clocks clocks;
  TimeSync sync;
  double last = 0;
  for (double t = clocks.host; t < clocks.host + 60; t += 0.01) {
    if (random() % 50 == 0) sync.add(t - way(random), clocks.board_at(t), t + way(random));
    const auto stamp = sync.to_host(clocks.board_at(t));
    if (!stamp) continue;
    ASSERT_GE(*stamp, last);
    last = *stamp;
  }
  EXPECT_GT(last, clocks.host + 59);
}

TEST(TimeSync, BeginsAnewWhereTheBoardClockSteps) {
  for (const std::int64_t step : {3600000000LL, 100000LL}) {
    Clocks clocks;
    TimeSync sync;
    double t = clocks.host;
    for (; t < clocks.host + 30; t += 0.5) sync.add(t - 0.001, clocks.board_at(t), t + 0.001);
    EXPECT_EQ(sync.steps(), 0U);
    clocks.board += static_cast<std::uint64_t>(step);
    for (int i = 0; i < 4; ++i, t += 0.5) {
      sync.add(t - 0.001, clocks.board_at(t), t + 0.001);
      EXPECT_EQ(sync.steps(), 1U);
      EXPECT_TRUE(sync.is_steady());
      EXPECT_NEAR(*sync.to_host(clocks.board_at(t + 0.1)), t + 0.1, 0.001);
    }
  }
}

TEST(TimeSync, TellsAClockOfAnotherRate) {
  for (const double drift : {1.0, -0.5, 0.05, -0.02}) {
    Clocks clocks;
    clocks.drift = drift;
    TimeSync sync;
    int steady = 0;
    for (double t = clocks.host; t < clocks.host + 60; t += 0.5) {
      sync.add(t - 0.001, clocks.board_at(t), t + 0.001);
      if (t > clocks.host + 20) steady += sync.is_steady() ? 1 : 0;
    }
    EXPECT_EQ(steady, 0) << drift;
    // A clock that runs well again is used again.
    clocks.board = clocks.board_at(clocks.host + 60);
    clocks.host += 60;
    clocks.drift = 0;
    for (double t = clocks.host; t < clocks.host + 10; t += 0.5) {
      sync.add(t - 0.001, clocks.board_at(t), t + 0.001);
    }
    EXPECT_TRUE(sync.is_steady()) << drift;
  }
}

TEST(TimeSync, ConvertsOlderTimesAgain) {
  TimeSync sync;
  sync.add(10, 1000000, 10.001);
  const double later = *sync.to_host(3000000);
  EXPECT_NEAR(later - *sync.to_host(2000000), 1, 1e-6);
}

TEST(TimeSync, ForgetsTheClockOnReset) {
  TimeSync sync;
  sync.add(10, 5000000, 10.001);
  EXPECT_FALSE(sync.add(11, 100, 11.001)) << "the board clock ran backwards";
  sync.reset();
  EXPECT_TRUE(sync.add(11, 100, 11.001));
  EXPECT_NEAR(*sync.to_host(100), 11.0005, 1e-9);
}

}  // namespace
}  // namespace fpga_stereo::test
