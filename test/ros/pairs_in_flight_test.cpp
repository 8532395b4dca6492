#include "ros/pairs_in_flight.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

SourcePair pair(std::uint64_t number) {
  SourcePair made;
  made.number = number;
  return made;
}

class PairsInFlightTest : public testing::Test {
 protected:
  void send(std::uint64_t number) { pairs_.add(pair(number), now_); }

  PairsInFlight pairs_;
  PairsInFlight::Clock::time_point now_{seconds(1000)};
};

TEST_F(PairsInFlightTest, ReturnsThePairOfAFrame) {
  const std::uint64_t id = pairs_.next_id();
  send(7);
  const auto returned = pairs_.take(id, now_);
  ASSERT_TRUE(returned);
  EXPECT_EQ(returned->pair.number, 7U);
  EXPECT_EQ(returned->lost, 0U);
  EXPECT_FALSE(pairs_.take(id, now_)) << "only once";
}

TEST_F(PairsInFlightTest, OlderPairsAreLostWhenANewerOneReturns) {
  for (std::uint64_t i = 1; i <= 4; ++i) send(i);
  EXPECT_TRUE(pairs_.is_full());
  const auto returned = pairs_.take(3, now_);
  ASSERT_TRUE(returned);
  EXPECT_EQ(returned->lost, 2U);
  EXPECT_FALSE(pairs_.take(1, now_));
  EXPECT_TRUE(pairs_.take(4, now_));
  EXPECT_TRUE(pairs_.is_empty());
}

TEST_F(PairsInFlightTest, GivesUpAfterSeveralTurnarounds) {
  send(1);
  now_ += milliseconds(1000);  // the turnaround
  ASSERT_TRUE(pairs_.take(1, now_));
  send(2);
  send(3);
  now_ += milliseconds(5900);
  EXPECT_EQ(pairs_.give_up_late(now_), 0U);
  now_ += milliseconds(200);  // more than 2 s and 4 turnarounds
  EXPECT_EQ(pairs_.give_up_late(now_), 2U);
  EXPECT_TRUE(pairs_.is_empty());
  EXPECT_FALSE(pairs_.take(2, now_));
}

TEST_F(PairsInFlightTest, TakesAllFromTheOldestToTheNewest) {
  send(5);
  send(6);
  const auto all = pairs_.take_all();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].number, 5U);
  EXPECT_EQ(all[1].number, 6U);
  EXPECT_TRUE(pairs_.is_empty());
}

}  // namespace
}  // namespace fpga_stereo::test
