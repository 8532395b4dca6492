#include "fpga_stereo/core/target.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

namespace fpga_stereo::test {
namespace {

TEST(Target, TheBestIsTheDefaultAndScalarTheLast) {
  const std::vector<std::string> all = targets();
  EXPECT_EQ(all.back(), "scalar");
  if (std::getenv(kTargetVariable) == nullptr) {
    EXPECT_EQ(target(), all.front());
  }
}

TEST(Target, AnyOfThisMachineCanBeChosen) {
  const std::string before = target();
  for (const std::string& name : targets()) {
    EXPECT_TRUE(choose_target(name));
    EXPECT_EQ(target(), name);
  }
  EXPECT_TRUE(choose_target(before));
}

TEST(Target, AnUnknownOneIsRefusedByName) {
  const std::string before = target();
  const Status refused = choose_target("MMX");
  ASSERT_FALSE(refused);
  std::string allowed;
  for (const std::string& name : targets()) allowed += (allowed.empty() ? "" : ", ") + name;
  EXPECT_EQ(
      refused.error().message,
      "'MMX' is no target of this machine and build (FPGA_STEREO_TARGET): allowed " + allowed);
  EXPECT_EQ(target(), before);
}

TEST(Target, TheVariableForcesOne) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";  // a new process: it is read once
  EXPECT_EXIT(
      {
        setenv(kTargetVariable, "scalar", 1);
        std::exit(check_target_variable() && target() == "scalar" ? 0 : 1);
      },
      ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace fpga_stereo::test
