// fs_async_fifo at many clock ratios, with synchronisers that delay bits at random (fs_sync.sv in
// this folder), and with resets of either side at any time.
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
class FifoRig {
 public:
  FifoRig(int write_period, int read_period, int jitter, unsigned seed)
      : clocks(write_period, read_period, jitter, seed), random(seed) {
    model.wr_rst_ni = model.rd_rst_ni = 0;
    for (int i = 0; i < 100; ++i) step();
    model.wr_rst_ni = model.rd_rst_ni = 1;
  }

  /// Runs to the next edge of either clock. Words are consecutive numbers.
  void step() {
    const int edges = clocks.next();
    model.eval();
    const bool push = (edges & 1) && model.wr_rst_ni && model.wr_valid_i && model.wr_ready_o;
    const bool pop = (edges & 2) && model.rd_rst_ni && model.rd_valid_o && model.rd_ready_i;
    const bool is_stalled = (edges & 2) && model.rd_valid_o && !model.rd_ready_i && model.rd_rst_ni;
    const std::uint32_t word = model.rd_data_o;
    if (pop) take_word(word);
    if (push) stored.push_back(model.wr_data_i);
    max_stored = std::max(max_stored, stored.size());
    model.wr_clk_i = edges & 1;
    model.rd_clk_i = edges >> 1;
    model.eval();
    model.wr_clk_i = model.rd_clk_i = 0;
    if (is_stalled && expects_every_word) {
      EXPECT_TRUE(model.rd_valid_o);
      EXPECT_EQ(model.rd_data_o, word);
    }
    if (edges & 1) {
      if (push) ++next_word;
      if (push || !model.wr_valid_i) model.wr_valid_i = chance(push_chance);
      model.wr_data_i = next_word;
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

  /// Stops pushing and runs until the FIFO is empty.
  void drain() {
    const double push = push_chance, pop = pop_chance;
    push_chance = 0, pop_chance = 1;
    int quiet_clocks = 0;
    for (int i = 0; i < 20000 && quiet_clocks < 60 && !testing::Test::HasFailure(); ++i) {
      step();
      quiet_clocks = model.rd_valid_o || model.wr_valid_i ? 0 : quiet_clocks + 1;
    }
    EXPECT_GE(quiet_clocks, 60) << "the FIFO does not become empty";
    push_chance = push, pop_chance = pop;
  }

  Model model;
  TwoClocks clocks;
  std::mt19937 random;
  double push_chance = 1, pop_chance = 1;
  std::deque<std::uint32_t> stored;
  std::uint32_t next_word = 1;  // to be pushed
  std::uint32_t last_word = 0;  // last one popped
  std::size_t max_stored = 0;
  /// False after a reset: words may be lost, but none may repeat or come out before it was pushed.
  bool expects_every_word = true;
  int popped = 0, write_clocks = 0, read_clocks = 0;

 private:
  bool chance(double p) { return random() < p * 4294967296.; }

  void take_word(std::uint32_t word) {
    ++popped;
    if (expects_every_word) {
      ASSERT_FALSE(stored.empty()) << "popped " << word << " from an empty FIFO";
      ASSERT_EQ(word, stored.front());
      stored.pop_front();
    } else {
      ASSERT_GT(word, last_word);
      ASSERT_LT(word, next_word);
    }
    last_word = word;
  }
};

template <class Model>
void random_traffic(int write_period, int read_period, int jitter) {
  SCOPED_TRACE(testing::Message() << write_period << ":" << read_period << " + " << jitter);
  FifoRig<Model> rig(write_period, read_period, jitter, write_period * 1000 + read_period);
  for (int i = 0; i < 40; ++i) {
    const double chances[] = {1, 0.9, 0.5, 0.1, 0};
    rig.push_chance = chances[rig.random() % 5];
    rig.pop_chance = chances[rig.random() % 5];
    if (jitter > 0) {  // the clocks drift
      rig.clocks.set_periods(write_period + static_cast<int>(rig.random() % 20),
                             read_period + static_cast<int>(rig.random() % 20));
    }
    rig.run(1500);
    if (testing::Test::HasFailure()) return;
  }
  rig.push_chance = 1, rig.pop_chance = 0;
  rig.run(2000);
  rig.drain();
  EXPECT_TRUE(rig.stored.empty());
  EXPECT_GT(rig.popped, 300);
}

TEST(RtlAsyncFifo, KeepsWordsInOrderAtAnyClockRatio) {
  const int ratios[][3] = {{10, 10, 0}, {30, 50, 0}, {100, 60, 0}, {60, 100, 0}, {20, 1, 0},
                           {1, 20, 0},  {97, 98, 0}, {50, 50, 3},  {60, 100, 7}, {100, 30, 20}};
  for (const auto& ratio : ratios) {
    random_traffic<AsyncFifo4>(ratio[0], ratio[1], ratio[2]);
    random_traffic<AsyncFifo128>(ratio[0], ratio[1], ratio[2]);
    if (HasFailure()) return;
  }
}

TEST(RtlAsyncFifo, HoldsDepthPlusOneWords) {
  FifoRig<AsyncFifo4> small(10, 13, 0, 1);
  small.pop_chance = 0;
  small.run(200);
  EXPECT_EQ(small.max_stored, 5U);
  FifoRig<AsyncFifo128> large(10, 13, 0, 1);
  large.pop_chance = 0;
  large.run(2000);
  EXPECT_EQ(large.max_stored, 129U);
}

TEST(RtlAsyncFifo, PassesOneWordPerClock) {
  FifoRig<AsyncFifo128> rig(100, 101, 0, 3);  // the reader is slower and never waits
  rig.run(1000);
  const int popped = rig.popped, clocks = rig.read_clocks;
  rig.run(10000);
  EXPECT_EQ(rig.popped - popped, rig.read_clocks - clocks);
  FifoRig<AsyncFifo128> slow(101, 100, 0, 3);  // the writer is slower
  slow.run(1000);
  const auto next_word = slow.next_word;
  const int write_clocks = slow.write_clocks;
  slow.run(10000);
  EXPECT_EQ(slow.next_word - next_word,
            static_cast<std::uint32_t>(slow.write_clocks - write_clocks));
}

TEST(RtlAsyncFifo, HasALatencyOfThreeOrFourClocks) {
  int seen[8] = {};
  for (unsigned seed = 0; seed < 200; ++seed) {
    FifoRig<AsyncFifo4> rig(10, 10, 0, seed);
    rig.push_chance = rig.pop_chance = 0;
    rig.run(60 + static_cast<int>(seed % 9));
    rig.drain();
    rig.push_chance = 1;
    for (int i = 0; i < 100 && rig.stored.empty(); ++i) rig.step();
    const int from = rig.read_clocks;
    for (int i = 0; i < 100 && !rig.model.rd_valid_o; ++i) rig.step();
    ASSERT_LT(rig.read_clocks - from, 8);
    ++seen[rig.read_clocks - from];
  }
  EXPECT_GT(seen[3], 0);
  EXPECT_GT(seen[4], 0);
  EXPECT_EQ(seen[3] + seen[4], 200);
}

/// Resets either side for a few clocks, up to four times in a row, and checks that the FIFO works
/// afterwards.
template <class Model>
void check_resets(int write_period, int read_period) {
  SCOPED_TRACE(testing::Message() << write_period << ":" << read_period);
  FifoRig<Model> rig(write_period, read_period, 1, write_period);
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    rig.expects_every_word = true;
    const double chances[] = {0.01, 0.05, 0.3, 0.7, 1};
    rig.push_chance = chances[rig.random() % 5];
    rig.pop_chance = 0.2 * (rig.random() % 6);
    rig.run(static_cast<int>(rig.random() % 300));
    rig.expects_every_word = false;
    for (unsigned k = 0, resets = 1 + rig.random() % 4; k < resets; ++k) {
      const bool resets_writer = rig.random() % 2 != 0;
      auto& reset = resets_writer ? rig.model.wr_rst_ni : rig.model.rd_rst_ni;
      const int& clocks = resets_writer ? rig.write_clocks : rig.read_clocks;
      const int until = clocks + 1 + static_cast<int>(rig.random() % 3);
      const std::uint32_t next_word = rig.next_word;
      reset = 0;
      while (clocks != until) rig.step();
      reset = 1;
      if (!resets_writer)
        rig.last_word = std::max(rig.last_word, next_word - 1);  // earlier words are lost
      rig.run(static_cast<int>(rig.random() % 60));
      if (testing::Test::HasFailure()) return;
    }
    rig.drain();
    if (testing::Test::HasFailure()) return;
    rig.stored.clear();
    // The FIFO works again: it accepts ten words.
    rig.expects_every_word = true;
    const auto next_word = rig.next_word;
    rig.push_chance = 1, rig.pop_chance = 1;
    for (int k = 0; k < 3000 && rig.next_word < next_word + 10; ++k) rig.step();
    ASSERT_GE(rig.next_word, next_word + 10);
  }
}

TEST(RtlAsyncFifo, AResetOfEitherSideEmptiesBoth) {
  check_resets<AsyncFifo4>(10, 10);
  check_resets<AsyncFifo4>(100, 7);
  check_resets<AsyncFifo4>(7, 100);
  check_resets<AsyncFifo128>(60, 100);
}

TEST(RtlAsyncFifo, AResetOfBothRecoversFromAnyState) {
  Verilated::randReset(2);  // flip-flops start with random values
  for (int seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Verilated::randSeed(seed);
    FifoRig<AsyncFifo4> rig(30, 10 + 20 * (seed % 3), 0, seed);
    rig.run(300);
    EXPECT_GT(rig.popped, 30);
    if (HasFailure()) break;
  }
  Verilated::randReset(0);
}

TEST(RtlAsyncFifo, AcceptsNothingWhileTheOtherClockIsStopped) {
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
  // After a reset with the other clock stopped, the FIFO accepts words only once that clock has run
  // and emptied its side.
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
