#include "link/host_clock.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

TEST(HostClock, NoticesThatTheTimeOfDayWasSet) {
  link::HostClock clock;
  const auto at = [](double s) {
    return link::Time(
        std::chrono::duration_cast<link::Clock::duration>(std::chrono::duration<double>(s)));
  };
  EXPECT_EQ(clock.read(at(100), 5000), 0);
  EXPECT_EQ(clock.read(at(101), 5001.0005), 0) << "slewed";
  EXPECT_NEAR(clock.wall(102), 5002.0005, 1e-6);
  EXPECT_NEAR(clock.read(at(102), 1402), -3600.0005, 1e-6);
  EXPECT_NEAR(clock.wall(101), 1401, 1e-6) << "times before the step follow it";
  EXPECT_EQ(clock.read(at(103), 1403), 0);
  EXPECT_EQ(clock.steps(), 1U);
}

}  // namespace
}  // namespace fpga_stereo::test
