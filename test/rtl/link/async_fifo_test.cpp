// fs_async_fifo at clocks of any ratio, with synchronisers whose bits come late (fs_sync.sv of this
// folder), and with resets of either side at any time.
#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <random>

#include "AsyncFifo128.h"
#include "AsyncFifo4.h"
#include "rtl/link/two_clocks.hpp"

namespace fpga_stereo::test {
namespace {

template <class Model>
class Bench {
 public:
  Bench(int write_period, int read_period, int jitter, unsigned seed)
      : clocks(write_period, read_period, jitter, seed), random(seed) {
    model.wr_rst_ni = model.rd_rst_ni = 0;
    for (int i = 0; i < 100; ++i) step();
    model.wr_rst_ni = model.rd_rst_ni = 1;
  }

  /// One edge of one clock, or of both. Words are numbered.
  void step() {
    const int edges = clocks.next();
    model.eval();
    const bool push = (edges & 1) && model.wr_rst_ni && model.wr_valid_i && model.wr_ready_o;
    const bool pop = (edges & 2) && model.rd_rst_ni && model.rd_valid_o && model.rd_ready_i;
    const bool held = (edges & 2) && model.rd_valid_o && !model.rd_ready_i && model.rd_rst_ni;
    const std::uint32_t word = model.rd_data_o;
    if (pop) take(word);
    if (push) inside.push_back(model.wr_data_i);
    most = std::max(most, inside.size());
    model.wr_clk_i = edges & 1;
    model.rd_clk_i = edges >> 1;
    model.eval();
    model.wr_clk_i = model.rd_clk_i = 0;
    if (held && exact) {
      EXPECT_TRUE(model.rd_valid_o);
      EXPECT_EQ(model.rd_data_o, word);
    }
    if (edges & 1) {
      if (push) ++number;
      if (push || !model.wr_valid_i) model.wr_valid_i = chance(push_chance);
      model.wr_data_i = number;
      ++write_clocks;
    }
    if (edges & 2) {
      model.rd_ready_i = chance(pop_chance);
      ++read_clocks;
    }
  }

  void run(int edges) {
    for (int i = 0; i < edges && !testing::Test::HasFailure(); ++i) step();
  }

  /// Nothing more is pushed, and what is inside is left to come out.
  void drain() {
    const double push = push_chance, pop = pop_chance;
    push_chance = 0, pop_chance = 1;
    int quiet = 0;
    for (int i = 0; i < 20000 && quiet < 60 && !testing::Test::HasFailure(); ++i) {
      step();
      quiet = model.rd_valid_o || model.wr_valid_i ? 0 : quiet + 1;
    }
    EXPECT_GE(quiet, 60) << "stuck";
    push_chance = push, pop_chance = pop;
  }

  Model model;
  TwoClocks clocks;
  std::mt19937 random;
  double push_chance = 1, pop_chance = 1;
  std::deque<std::uint32_t> inside;
  std::uint32_t number = 1;  // of the next word
  std::uint32_t last = 0;    // that came out
  std::size_t most = 0;
  bool exact = true;  // else there was a reset: words may lack, but none comes twice, or too early
  int popped = 0, write_clocks = 0, read_clocks = 0;

 private:
  bool chance(double p) { return random() < p * 4294967296.; }

  void take(std::uint32_t word) {
    ++popped;
    if (exact) {
      ASSERT_FALSE(inside.empty()) << "a word from nothing: " << word;
      ASSERT_EQ(word, inside.front());
      inside.pop_front();
    } else {
      ASSERT_GT(word, last);
      ASSERT_LT(word, number);
    }
    last = word;
  }
};

template <class Model>
void random_traffic(int write_period, int read_period, int jitter) {
  SCOPED_TRACE(testing::Message() << write_period << ":" << read_period << " + " << jitter);
  Bench<Model> bench(write_period, read_period, jitter, write_period * 1000 + read_period);
  for (int i = 0; i < 40; ++i) {
    const double chances[] = {1, 0.9, 0.5, 0.1, 0};
    bench.push_chance = chances[bench.random() % 5];
    bench.pop_chance = chances[bench.random() % 5];
    if (jitter > 0) {  // drifts
      bench.clocks.set_periods(write_period + static_cast<int>(bench.random() % 20),
                               read_period + static_cast<int>(bench.random() % 20));
    }
    bench.run(1500);
    if (testing::Test::HasFailure()) return;
  }
  bench.push_chance = 1, bench.pop_chance = 0;
  bench.run(2000);
  bench.drain();
  EXPECT_TRUE(bench.inside.empty());
  EXPECT_GT(bench.popped, 300);
}

TEST(RtlAsyncFifo, AnyRatioOfClocks) {
  const int ratios[][3] = {{10, 10, 0}, {30, 50, 0}, {100, 60, 0}, {60, 100, 0}, {20, 1, 0},
                           {1, 20, 0},  {97, 98, 0}, {50, 50, 3},  {60, 100, 7}, {100, 30, 20}};
  for (const auto& ratio : ratios) {
    random_traffic<AsyncFifo4>(ratio[0], ratio[1], ratio[2]);
    random_traffic<AsyncFifo128>(ratio[0], ratio[1], ratio[2]);
    if (HasFailure()) return;
  }
}

TEST(RtlAsyncFifo, HoldsDepthWordsAndOneInTheRegister) {
  Bench<AsyncFifo4> small(10, 13, 0, 1);
  small.pop_chance = 0;
  small.run(200);
  EXPECT_EQ(small.most, 5U);
  Bench<AsyncFifo128> large(10, 13, 0, 1);
  large.pop_chance = 0;
  large.run(2000);
  EXPECT_EQ(large.most, 129U);
}

TEST(RtlAsyncFifo, AWordPerClock) {
  Bench<AsyncFifo128> bench(100, 101, 0, 3);  // the reader is slower, and never waits
  bench.run(1000);
  const int popped = bench.popped, clocks = bench.read_clocks;
  bench.run(10000);
  EXPECT_EQ(bench.popped - popped, bench.read_clocks - clocks);
  Bench<AsyncFifo128> slow(101, 100, 0, 3);  // the writer is slower
  slow.run(1000);
  const auto number = slow.number;
  const int write_clocks = slow.write_clocks;
  slow.run(10000);
  EXPECT_EQ(slow.number - number, static_cast<std::uint32_t>(slow.write_clocks - write_clocks));
}

TEST(RtlAsyncFifo, LatencyIsThreeOrFourClocks) {
  int seen[8] = {};
  for (unsigned seed = 0; seed < 200; ++seed) {
    Bench<AsyncFifo4> bench(10, 10, 0, seed);
    bench.push_chance = bench.pop_chance = 0;
    bench.run(60 + static_cast<int>(seed % 9));
    bench.drain();
    bench.push_chance = 1;
    for (int i = 0; i < 100 && bench.inside.empty(); ++i) bench.step();
    const int from = bench.read_clocks;
    for (int i = 0; i < 100 && !bench.model.rd_valid_o; ++i) bench.step();
    ASSERT_LT(bench.read_clocks - from, 8);
    ++seen[bench.read_clocks - from];
  }
  EXPECT_GT(seen[3], 0);
  EXPECT_GT(seen[4], 0);
  EXPECT_EQ(seen[3] + seen[4], 200);
}

/// Resets of one clock or more, of either side, or of both, one soon after the other.
template <class Model>
void resets(int write_period, int read_period) {
  SCOPED_TRACE(testing::Message() << write_period << ":" << read_period);
  Bench<Model> bench(write_period, read_period, 1, write_period);
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    bench.exact = true;
    const double chances[] = {0.01, 0.05, 0.3, 0.7, 1};
    bench.push_chance = chances[bench.random() % 5];
    bench.pop_chance = 0.2 * (bench.random() % 6);
    bench.run(static_cast<int>(bench.random() % 300));
    bench.exact = false;
    for (unsigned k = 0, resets = 1 + bench.random() % 4; k < resets; ++k) {
      const bool write = bench.random() % 2 != 0;
      auto& reset = write ? bench.model.wr_rst_ni : bench.model.rd_rst_ni;
      const int& clocks = write ? bench.write_clocks : bench.read_clocks;
      const int until = clocks + 1 + static_cast<int>(bench.random() % 3);
      const std::uint32_t number = bench.number;
      reset = 0;
      while (clocks != until) bench.step();
      reset = 1;
      if (!write) bench.last = std::max(bench.last, number - 1);  // none of those comes out now
      bench.run(static_cast<int>(bench.random() % 60));
      if (testing::Test::HasFailure()) return;
    }
    bench.drain();
    if (testing::Test::HasFailure()) return;
    bench.inside.clear();
    // It works again: so many words get in.
    bench.exact = true;
    const auto number = bench.number;
    bench.push_chance = 1, bench.pop_chance = 1;
    for (int k = 0; k < 3000 && bench.number < number + 10; ++k) bench.step();
    ASSERT_GE(bench.number, number + 10);
  }
}

TEST(RtlAsyncFifo, ResetOfEitherSideEmptiesBoth) {
  resets<AsyncFifo4>(10, 10);
  resets<AsyncFifo4>(100, 7);
  resets<AsyncFifo4>(7, 100);
  resets<AsyncFifo128>(60, 100);
}

TEST(RtlAsyncFifo, AResetOfBothMakesOrderOfAnyState) {
  Verilated::randReset(2);  // flip-flops start at random
  for (int seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Verilated::randSeed(seed);
    Bench<AsyncFifo4> bench(30, 10 + 20 * (seed % 3), 0, seed);
    bench.run(300);
    EXPECT_GT(bench.popped, 30);
    if (HasFailure()) break;
  }
  Verilated::randReset(0);
}

TEST(RtlAsyncFifo, NothingIsTakenWhileTheOtherClockStands) {
  AsyncFifo4 model;
  const auto clock_write = [&](int clocks) {
    for (int i = 0; i < clocks; ++i) {
      model.wr_clk_i = 1;
      model.eval();
      model.wr_clk_i = 0;
      model.eval();
    }
  };
  const auto clock_read = [&](int clocks) {
    for (int i = 0; i < clocks; ++i) {
      model.rd_clk_i = 1;
      model.eval();
      model.rd_clk_i = 0;
      model.eval();
    }
  };
  model.wr_rst_ni = model.rd_rst_ni = 0;
  for (int i = 0; i < 20; ++i) clock_write(1), clock_read(1);
  model.wr_rst_ni = model.rd_rst_ni = 1;
  clock_write(100);
  EXPECT_FALSE(model.wr_ready_o);
  for (int i = 0; i < 20; ++i) clock_write(1), clock_read(1);
  EXPECT_TRUE(model.wr_ready_o);
  // A reset while the other clock stands: nothing is taken until that one has emptied its side.
  model.wr_rst_ni = 0;
  clock_write(1);
  model.wr_rst_ni = 1;
  clock_write(100);
  EXPECT_FALSE(model.wr_ready_o);
  for (int i = 0; i < 20; ++i) clock_write(1), clock_read(1);
  EXPECT_TRUE(model.wr_ready_o);
}

}  // namespace
}  // namespace fpga_stereo::test
