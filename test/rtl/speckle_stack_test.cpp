// Compares fs_speckle_stack with a std::vector, also in orders of pushes and pops that fs_speckle
// never produces.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "SpeckleStack.h"

namespace fpga_stereo::test {
namespace {

constexpr int kDepth = 12;

TEST(RtlSpeckleStack, EqualsAVectorUnderRandomPushesAndPops) {
  std::mt19937 random(1);
  SpeckleStack stack;
  const auto clock = [&] {
    stack.clk_i = 0;
    stack.eval();
    stack.clk_i = 1;
    stack.eval();
  };
  stack.rst_ni = 0;
  stack.en_i = 1;
  stack.clear_i = stack.push_i = stack.pop_i = 0;
  clock();
  stack.rst_ni = 1;
  std::vector<std::uint32_t> words;
  for (int tick = 0; tick < 50000; ++tick) {
    if (!words.empty()) {
      ASSERT_EQ(stack.top_o, words.back()) << "tick " << tick;
    }
    // Phases of mostly pushes alternate with phases of mostly pops.
    const bool up = random() % 8 < (tick % 64 < 32 ? 5U : 2U);
    const bool acts = random() % 4 != 0;
    const std::uint32_t word = random() & 0xFF;
    stack.en_i = random() % 5 != 0 ? 1 : 0;
    stack.clear_i = random() % 500 == 0 ? 1 : 0;
    stack.push_i = !stack.clear_i && acts && up && words.size() < kDepth ? 1 : 0;
    stack.pop_i = !stack.clear_i && acts && !up && !words.empty() ? 1 : 0;
    stack.data_i = word;
    clock();
    if (!stack.en_i) continue;
    if (stack.clear_i) words.clear();
    if (stack.push_i) words.push_back(word);
    if (stack.pop_i) words.pop_back();
  }
}

}  // namespace
}  // namespace fpga_stereo::test
