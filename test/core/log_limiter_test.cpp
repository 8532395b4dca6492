#include "core/log_limiter.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using Count = std::optional<std::uint64_t>;

const LogLimiter::Clock::time_point kStart{seconds(1000)};

TEST(LogLimiter, AdmitsOneLineInTenSecondsAndCountsTheOthers) {
  LogLimiter limiter;
  EXPECT_EQ(limiter.admit("stamp", kStart), Count(0));
  for (int i = 1; i <= 99; ++i) {
    EXPECT_EQ(limiter.admit("stamp", kStart + milliseconds(100 * i)), std::nullopt);
  }
  EXPECT_EQ(limiter.admit("stamp", kStart + milliseconds(9999)), std::nullopt);
  EXPECT_EQ(limiter.admit("stamp", kStart + seconds(10)), Count(100));
  EXPECT_EQ(limiter.admit("stamp", kStart + seconds(19)), std::nullopt);
  EXPECT_EQ(limiter.admit("stamp", kStart + seconds(60)), Count(1));
  EXPECT_EQ(limiter.admit("stamp", kStart + seconds(70)), Count(0));
}

TEST(LogLimiter, KeepsCausesApart) {
  LogLimiter limiter;
  EXPECT_EQ(limiter.admit("stamp", kStart), Count(0));
  EXPECT_EQ(limiter.admit("encoding", kStart + seconds(5)), Count(0));
  EXPECT_EQ(limiter.admit("stamp", kStart + seconds(9)), std::nullopt);
  EXPECT_EQ(limiter.admit("encoding", kStart + seconds(10)), std::nullopt);
  EXPECT_EQ(limiter.admit("stamp", kStart + seconds(10)), Count(1));
  EXPECT_EQ(limiter.admit("encoding", kStart + seconds(15)), Count(1));
}

TEST(LogLimiter, LetsManyCausesShareALine) {
  LogLimiter limiter;
  int lines = 0;
  for (int i = 0; i < 100000; ++i) lines += limiter.admit(std::to_string(i), kStart) ? 1 : 0;
  EXPECT_EQ(lines, int{LogLimiter::kMaxCauses} + 1);
  EXPECT_EQ(limiter.admit("another", kStart + milliseconds(9999)), std::nullopt);
  EXPECT_EQ(limiter.admit("another", kStart + seconds(10)), Count(0)) << "has its own place again";
}

TEST(LogLimiter, NotesHowManyLinesWereKeptBack) {
  EXPECT_EQ(with_kept_back("pair refused", 0), "pair refused");
  EXPECT_EQ(with_kept_back("pair refused", 1), "pair refused (1 similar message was not logged)");
  EXPECT_EQ(with_kept_back("pair refused", 7), "pair refused (7 similar messages were not logged)");
}

}  // namespace
}  // namespace fpga_stereo::test
