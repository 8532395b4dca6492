#include "fpga_stereo/core/target.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace fpga_stereo::test {
namespace {

TEST(Target, DefaultIsTheFirstAndScalarIsTheLast) {
  const std::vector<std::string> all = targets();
  EXPECT_EQ(all.back(), "scalar");
  if (std::getenv(kTargetVariable) == nullptr) {
    EXPECT_EQ(target(), all.front());
  }
}

TEST(Target, EveryTargetOfThisMachineCanBeChosen) {
  const std::string before = target();
  for (const std::string& name : targets()) {
    EXPECT_TRUE(choose_target(name));
    EXPECT_EQ(target(), name);
  }
  EXPECT_TRUE(choose_target(before));
}

TEST(Target, RefusesUnknownNames) {
  const std::string before = target();
  const Status refused = choose_target("MMX");
  ASSERT_FALSE(refused);
  std::string allowed;
  for (const std::string& name : targets()) allowed += (allowed.empty() ? "" : ", ") + name;
  EXPECT_EQ(refused.error().message,
            "SIMD target 'MMX' is not available on this machine and build: allowed " + allowed);
  EXPECT_EQ(target(), before);
}

TEST(Target, EnvironmentVariableForcesATarget) {
  ::testing::FLAGS_gtest_death_test_style =
      "threadsafe";  // runs in a new process, as the variable is read once
  EXPECT_EXIT(
      {
        setenv(kTargetVariable, "scalar", 1);
        std::exit(check_target_variable() && target() == "scalar" ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace fpga_stereo::test
