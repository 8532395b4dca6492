// fs_ft245 connected to an FT232H and an FT601 (ft245_chip.hpp).
#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "Ft245x32.h"
#include "Ft245x8.h"
#include "rtl/link/ft245_chip.hpp"

namespace fpga_stereo::test {
namespace {

constexpr int kBurst = 512;  // default Burst of fs_ft245

/// Returns the n-th word of a direction; the sequence looks random.
std::uint32_t word_of(std::uint32_t n, std::uint32_t direction) {
  std::uint32_t x = (n ^ direction) * 0x9E3779B1U;
  x = (x ^ (x >> 15)) * 0x85EBCA77U;
  return x ^ (x >> 13);
}

template <class Model>
class Ft245Rig {
 public:
  using Word = typename Ft245Chip<Model>::Word;
  static constexpr int kAll = (1 << Ft245Chip<Model>::kBytes) - 1;

  explicit Ft245Rig(unsigned seed = 1) : chip(model, seed), random_(seed) {
    model.rst_ni = 0;
    step(10);
    model.rst_ni = 1;
  }

  /// Runs one clock and checks every word that arrives on either side.
  void step() {
    model.eval();
    chip.before_edge();
    const bool is_sent = model.tx_valid_i && model.tx_ready_o;
    if (model.rx_valid_o && model.rx_ready_i) {
      ASSERT_EQ(model.rx_data_o, static_cast<Word>(word_of(received, 1)));
      ASSERT_EQ(model.rx_keep_o, keep_of(received));
      ++received;
    }
    model.clk_i = 1;
    model.eval();
    model.clk_i = 0;
    if (is_sent) ++tx_number;
    if (is_sent || !model.tx_valid_i) model.tx_valid_i = tx_number < tx_end && chance(tx_chance);
    model.tx_data_i = static_cast<Word>(word_of(tx_number, 0));
    model.rx_ready_i = chance(rx_chance);
    while (given < rx_end && chip.waiting() < 8) {
      chip.give(static_cast<Word>(word_of(given, 1)), keep_of(given));
      ++given;
    }
    chip.after_edge();
    if (chip.wrote) {
      const std::size_t n = chip.from_fpga.size() - 1;
      ASSERT_EQ(chip.from_fpga.back(), static_cast<Word>(word_of(n, 0))) << n;
    }
    if (!model.siwu_no) ++flush_clocks;
  }

  void step(int clocks) {
    for (int i = 0; i < clocks && !testing::Test::HasFailure(); ++i) step();
  }

  std::size_t written() const { return chip.from_fpga.size(); }

  Model model;
  Ft245Chip<Model> chip;
  std::uint32_t tx_number = 0, tx_end = 0;  // next word to send, and where to stop
  std::uint32_t given = 0, rx_end = 0, received = 0;
  double tx_chance = 1, rx_chance = 1;
  int flush_clocks = 0;

 private:
  bool chance(double p) { return p >= 1 || random_() < p * 4294967296.; }

  static int keep_of(std::uint32_t n) {
    if (kAll == 1) return 1;
    return n % 100 == 99 ? 1 + static_cast<int>(word_of(n, 2) % kAll) : kAll;
  }

  std::mt19937 random_;
};

template <class Model>
class RtlFt245 : public testing::Test {};
using Chips = testing::Types<Ft245x8, Ft245x32>;
TYPED_TEST_SUITE(RtlFt245, Chips);

TYPED_TEST(RtlFt245, PassesAMillionWordsEachWay) {
  const std::uint32_t words = 1000000;
  Ft245Rig<TypeParam> rig;
  rig.tx_end = rig.rx_end = words;
  std::mt19937 random(5);
  const Stalls stalls[] = {Stalls::kNone,      Stalls::kGlitches, Stalls::kRandom,
                           Stalls::kAlternate, Stalls::kPackets,  Stalls::kAlways};
  const double chances[] = {1, 1, 0.9, 0.5, 0.1};
  int clocks = 0;
  while ((rig.written() < words || rig.received < words) && clocks < 40 * 1000000) {
    rig.chip.read_stalls = stalls[random() % 6];
    rig.chip.write_stalls = stalls[random() % 6];
    rig.tx_chance = chances[random() % 5];
    rig.rx_chance = chances[random() % 5];
    const int more = 1 + static_cast<int>(random() % 5000);
    rig.step(more);
    if (this->HasFailure()) FAIL() << "in clock " << rig.chip.clocks;
    clocks += more;
  }
  EXPECT_EQ(rig.written(), words);
  EXPECT_EQ(rig.received, words);
  rig.chip.read_stalls = rig.chip.write_stalls = Stalls::kNone;
  rig.step(200);
  EXPECT_EQ(rig.written(), words);
  EXPECT_EQ(rig.received, words);
}

TYPED_TEST(RtlFt245, PassesOneWordPerClock) {
  const int words = 20000;
  Ft245Rig<TypeParam> rig;
  rig.tx_end = words;
  while (rig.written() == 0 && rig.chip.clocks < 100) rig.step();
  int start = rig.chip.clocks;
  rig.step(words - 1);
  EXPECT_EQ(rig.written(), static_cast<std::size_t>(words));
  rig.step(10);
  rig.rx_end = words;
  start = rig.chip.clocks;
  while (rig.received == 0 && rig.chip.clocks < start + 100) rig.step();
  rig.step(words - 1);
  EXPECT_EQ(rig.received, static_cast<std::uint32_t>(words));
}

TYPED_TEST(RtlFt245, HasTheDocumentedLatency) {
  Ft245Rig<TypeParam> rig;
  rig.tx_end = 1;
  while (!rig.model.tx_valid_i) rig.step();
  const int start = rig.chip.clocks;
  while (rig.model.wr_no && rig.chip.clocks < start + 100) rig.step();
  EXPECT_EQ(rig.chip.clocks - start, 4);
  rig.step(10);
  rig.rx_end = 1;
  while (!rig.chip.read && rig.chip.clocks < start + 100) rig.step();
  const int read = rig.chip.clocks;  // the chip sent the word at the previous edge
  while (!rig.model.rx_valid_o && rig.chip.clocks < read + 100) rig.step();
  EXPECT_EQ(rig.chip.clocks - read + 1, 3);
}

TYPED_TEST(RtlFt245, BothDirectionsShareTheBus) {
  Ft245Rig<TypeParam> rig;
  rig.tx_end = rig.rx_end = 1000000;
  rig.step(100);
  const std::size_t written = rig.written();
  const std::uint32_t received = rig.received;
  // One read burst and one write burst, 3 clocks from Write to Read and 1 clock back.
  const int clocks = 20 * (2 * (kBurst + 1) + 4);
  rig.step(clocks);
  EXPECT_NEAR(static_cast<double>(rig.written() - written), 20 * (kBurst + 1), kBurst);
  EXPECT_NEAR(static_cast<double>(rig.received - received), 20 * (kBurst + 1), kBurst);
  EXPECT_GE(rig.written() - written + rig.received - received, clocks - 20U * 4 - 4);
}

TYPED_TEST(RtlFt245, NeitherDirectionStarves) {
  Ft245Rig<TypeParam> rig;
  rig.tx_end = rig.rx_end = 1000000;
  int reads = 0, writes = 0;  // clocks since the last read or write
  for (int i = 0; i < 50000; ++i) {
    rig.step();
    reads = rig.chip.read ? 0 : reads + 1;
    writes = rig.chip.wrote ? 0 : writes + 1;
    ASSERT_LE(reads, kBurst + 8);
    ASSERT_LE(writes, kBurst + 8);
    ASSERT_FALSE(this->HasFailure());
  }
}

TYPED_TEST(RtlFt245, AStalledDirectionDoesNotStallTheOther) {
  Ft245Rig<TypeParam> rig;
  rig.tx_end = rig.rx_end = 1000000;
  rig.chip.write_stalls = Stalls::kAlways;  // the host reads nothing
  rig.step(1000);
  auto received = rig.received;
  rig.step(1000);
  EXPECT_EQ(rig.received - received, 1000U);
  rig.chip.write_stalls = Stalls::kNone;
  rig.rx_chance = 0;  // the FPGA accepts no commands
  rig.step(1000);
  auto written = rig.written();
  rig.step(1000);
  EXPECT_EQ(rig.written() - written, 1000U);
  rig.rx_chance = 1;
  rig.chip.read_stalls = Stalls::kAlways;  // the host writes nothing
  rig.step(1000);
  written = rig.written();
  rig.step(1000);
  EXPECT_EQ(rig.written() - written, 1000U);
}

TYPED_TEST(RtlFt245, MakesProgressWithAlternatingFlags) {
  Ft245Rig<TypeParam> rig;
  rig.tx_end = rig.rx_end = 1000000;
  rig.chip.read_stalls = rig.chip.write_stalls = Stalls::kAlternate;
  rig.step(20000);
  EXPECT_GT(rig.written(), 4500U);
  EXPECT_GT(rig.received, 4500U);
}

TYPED_TEST(RtlFt245, KeepsStrobesHighAndTheBusUndrivenInReset) {
  TypeParam model;
  model.rxf_ni = model.txe_ni = 0;
  model.rst_ni = 0;
  model.eval();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(model.rd_no, 1);
    EXPECT_EQ(model.wr_no, 1);
    EXPECT_EQ(model.oe_no, 1);
    EXPECT_EQ(model.siwu_no, 1);
    EXPECT_EQ(model.data_oe_o, 0);
    model.clk_i = 1;
    model.eval();
    model.clk_i = 0;
    model.eval();
  }
}

TYPED_TEST(RtlFt245, AResetLosesWordsButBreaksNoBusRule) {
  Ft245Rig<TypeParam> rig;
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    rig.tx_end = rig.rx_end = 1000000;
    rig.step(static_cast<int>(random() % 700));
    ASSERT_FALSE(this->HasFailure());
    rig.model.rst_ni = 0;
    for (int k = 0; k < 3; ++k) {
      rig.model.eval();
      rig.chip.before_edge();
      rig.model.clk_i = 1;
      rig.model.eval();
      rig.model.clk_i = 0;
      rig.chip.after_edge();
      if (k > 0) {
        ASSERT_TRUE(rig.model.rd_no && rig.model.wr_no && rig.model.oe_no);
      }
    }
    rig.model.rst_ni = 1;
    // Words inside fs_ft245 are lost, so both counts skip them.
    rig.model.tx_valid_i = 0;
    rig.chip.from_fpga.resize(rig.tx_number);
    rig.received = rig.given - static_cast<std::uint32_t>(rig.chip.waiting());
  }
}

TEST(RtlFt245Flush, FlushesOncePerSilence) {
  Ft245Rig<Ft245x8> rig;
  rig.step(500);
  EXPECT_EQ(rig.flush_clocks, 0);  // no word was written
  for (int i = 1; i <= 3; ++i) {
    rig.tx_end += 7;
    while (rig.written() < rig.tx_end && rig.chip.clocks < 10000) rig.step();
    int silent = 0;
    while (rig.model.siwu_no && silent < 1000) rig.step(), ++silent;
    EXPECT_EQ(silent, 51);
    rig.step(500);
    EXPECT_EQ(rig.flush_clocks, 4 * i);
  }
  // No flush while a word waits for the host, or between words.
  rig.chip.write_stalls = Stalls::kAlways;
  rig.tx_end += 1;
  rig.step(500);
  EXPECT_EQ(rig.flush_clocks, 12);
  rig.chip.write_stalls = Stalls::kNone;
  rig.tx_end += 1000;
  rig.tx_chance = 0.2;
  rig.step(4000);
  EXPECT_EQ(rig.flush_clocks, 12);
  rig.step(4000);
  EXPECT_EQ(rig.flush_clocks, 16);
}

TEST(RtlFt245Flush, NeverFlushesOnTheFt601) {
  Ft245Rig<Ft245x32> rig;
  rig.tx_end = 7;
  rig.step(5000);
  EXPECT_EQ(rig.written(), 7U);
  EXPECT_EQ(rig.flush_clocks, 0);
}

}  // namespace
}  // namespace fpga_stereo::test
