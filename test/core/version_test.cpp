#include "fpga_stereo/version.hpp"

#include <gtest/gtest.h>

#include <string>

namespace fpga_stereo::test {
namespace {

TEST(Version, TextAndNumbersAgree) {
  EXPECT_EQ(kPackageVersion, std::to_string(kPackageVersionMajor) + "." +
                                 std::to_string(kPackageVersionMinor) + "." +
                                 std::to_string(kPackageVersionPatch));
}

}  // namespace
}  // namespace fpga_stereo::test
