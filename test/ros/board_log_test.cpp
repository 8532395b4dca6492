#include "ros/board_log.hpp"

#include <gtest/gtest.h>

namespace fpga_stereo::test {
namespace {

TEST(BoardLog, AdmitsOneLineOfAKind) {
  BoardLog log;
  EXPECT_EQ(log.admit("board: register 0x00AB holds 7"), "board: register 0x00AB holds 7");
  EXPECT_FALSE(log.admit("board: register 0xFF12 holds 0xAB"));
  EXPECT_TRUE(log.admit("board: frame 5 dropped"));
  EXPECT_TRUE(log.admit("board: pair 5 dropped"));
  EXPECT_FALSE(log.admit("board: frame 123 dropped"));
}

}  // namespace
}  // namespace fpga_stereo::test
