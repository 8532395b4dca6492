// The exact effect of injected faults, and a board behind a faulty line.
#include "sim/virtual_board/fault_injector.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "link/decoder.hpp"
#include "link/session_rig.hpp"
#include "sim/virtual_board/faulty_board.hpp"

namespace fpga_stereo::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using sim::FaultInjector;
using sim::LineFault;

Bytes packets(int count, std::size_t payload, unsigned seed = 1) {
  std::mt19937 random(seed);
  Bytes stream;
  for (int i = 0; i < count; ++i) {
    Bytes contents(payload);
    for (auto& byte : contents) byte = static_cast<std::uint8_t>(random());
    link::Header header;
    header.sequence = static_cast<std::uint32_t>(i);
    link::append_packet(header, contents.data(), contents.size(), stream);
  }
  return stream;
}

/// Returns the sequence numbers of the packets in a stream.
std::vector<std::uint32_t> sequences(const Bytes& bytes) {
  link::Decoder decoder;
  decoder.push(bytes.data(), bytes.size());
  std::vector<std::uint32_t> found;
  while (const auto packet = decoder.next()) found.push_back(packet->header.sequence);
  return found;
}

Bytes through(FaultInjector& injector, const Bytes& in) {
  Bytes out;
  injector.push(in.data(), in.size(), out);
  injector.flush(out);
  return out;
}

/// Injects one fault into ten packets.
Bytes one(LineFault fault, std::uint64_t seed, std::uint64_t* done = nullptr) {
  FaultInjector injector({}, seed);
  injector.inject(fault, 1);
  const Bytes out = through(injector, packets(10, 60000 / 10));
  if (done != nullptr) *done = injector.counts()[static_cast<std::size_t>(fault)];
  return out;
}

FaultInjector::Rates all_rates(double rate) {
  FaultInjector::Rates rates;
  rates.fill(rate);
  return rates;
}

TEST(FaultInjector, ChangesNothingWithoutFaults) {
  FaultInjector injector({}, 1);
  const Bytes in = packets(20, 100);
  EXPECT_EQ(through(injector, in), in);
  EXPECT_EQ(injector.counts(), FaultInjector::Counts{});
}

TEST(FaultInjector, AppliesEachByteFault) {
  const Bytes in = packets(10, 6000);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::uint64_t done = 0;
    const Bytes flipped = one(LineFault::kFlip, seed, &done);
    ASSERT_EQ(flipped.size(), in.size());
    int bits = 0;
    for (std::size_t i = 0; i < in.size(); ++i) bits += __builtin_popcount(flipped[i] ^ in[i]);
    EXPECT_EQ(bits, 1);
    EXPECT_EQ(done, 1U);

    const Bytes dropped = one(LineFault::kDrop, seed);
    EXPECT_EQ(dropped.size(), in.size() - 1);
    for (const LineFault fault : {LineFault::kInsert, LineFault::kDouble}) {
      const Bytes longer = one(fault, seed);
      ASSERT_EQ(longer.size(), in.size() + 1);
      const auto at = std::mismatch(in.begin(), in.end(), longer.begin());
      EXPECT_TRUE(std::equal(at.first, in.end(), at.second + 1));
      if (fault == LineFault::kDouble) {
        EXPECT_EQ(*at.second, *(at.second - 1));
      }
    }
  }
}

TEST(FaultInjector, AppliesEachPacketFault) {
  using Numbers = std::vector<std::uint32_t>;
  const Numbers in = sequences(packets(10, 6000));
  const std::size_t packet = packets(1, 6000).size();
  int swaps = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Bytes lost = one(LineFault::kLose, seed);
    EXPECT_EQ(lost.size(), 9 * packet);
    EXPECT_EQ(sequences(lost).size(), 9U);

    Numbers twice = sequences(one(LineFault::kRepeat, seed));
    ASSERT_EQ(twice.size(), 11U);
    const auto same = std::adjacent_find(twice.begin(), twice.end());
    ASSERT_NE(same, twice.end());
    twice.erase(same);
    EXPECT_EQ(twice, in);

    Numbers swapped = sequences(one(LineFault::kSwap, seed));
    ASSERT_EQ(swapped.size(), 10U);
    const auto later = std::adjacent_find(swapped.begin(), swapped.end(), std::greater<>());
    if (later != swapped.end()) {  // not the last one, which has nothing to wait for
      std::iter_swap(later, later + 1);
      ++swaps;
    }
    EXPECT_EQ(swapped, in);

    const Bytes cut = one(LineFault::kTruncate, seed);
    EXPECT_LT(cut.size(), 10 * packet);
    EXPECT_GT(cut.size(), 9 * packet);
    EXPECT_EQ(sequences(cut).size(), 9U);

    const Bytes garbage = one(LineFault::kGarbage, seed);
    EXPECT_GT(garbage.size(), 10 * packet);
    EXPECT_LE(garbage.size(), 10 * packet + 600);
    EXPECT_EQ(sequences(garbage), in);
  }
  EXPECT_GT(swaps, 15);
}

TEST(FaultInjector, PassesOtherBytesWhileItSearchesForPackets) {
  Bytes in(100, 0xD5);
  const Bytes stream = packets(3, 700);
  in.insert(in.end(), stream.begin(), stream.end() - 5);
  in.insert(in.end(), stream.begin(), stream.end());
  FaultInjector injector(all_rates(1e-9), 1);
  EXPECT_EQ(through(injector, in), in);
}

TEST(FaultInjector, DoesNotDependOnTheSplitOfTheBytes) {
  Bytes in(100, 0xD5);  // not packets, but each byte looks like the start of one
  const Bytes stream = packets(300, 700);
  in.insert(in.end(), stream.begin(), stream.end());
  FaultInjector whole(all_rates(200), 7);
  const Bytes expected = through(whole, in);
  ASSERT_NE(expected, in);
  for (const std::uint64_t done : whole.counts()) EXPECT_GT(done, 0U);
  for (const std::size_t step : {1U, 7U, 36U, 1000U}) {
    FaultInjector split(all_rates(200), 7);
    Bytes out;
    for (std::size_t at = 0; at < in.size(); at += step) {
      split.push(&in[at], std::min(step, in.size() - at), out);
    }
    split.flush(out);
    EXPECT_EQ(out, expected) << step;
    EXPECT_EQ(split.counts(), whole.counts());
  }
  FaultInjector other(all_rates(200), 8);
  EXPECT_NE(through(other, in), expected);
}

TEST(FaultInjector, KeepsItsRate) {
  FaultInjector::Rates rates{};
  rates[static_cast<std::size_t>(LineFault::kFlip)] = 100;
  rates[static_cast<std::size_t>(LineFault::kLose)] = 50;
  FaultInjector injector(rates, 3);
  Bytes out;
  const Bytes in = packets(1, 216);                                             // 256 bytes
  for (int i = 0; i < 4 * 4096; ++i) injector.push(in.data(), in.size(), out);  // 4 MiB
  const auto& counts = injector.counts();
  EXPECT_NEAR(static_cast<double>(counts[static_cast<std::size_t>(LineFault::kFlip)]), 400, 60);
  EXPECT_NEAR(static_cast<double>(counts[static_cast<std::size_t>(LineFault::kLose)]), 200, 45);
  EXPECT_EQ(counts[static_cast<std::size_t>(LineFault::kDrop)], 0U);
}

TEST(FaultInjector, HoldsAPacketUntilItsEndOrASilence) {
  FaultInjector::Rates rates{};
  rates[static_cast<std::size_t>(LineFault::kLose)] = 1e-6;
  FaultInjector injector(rates, 1);
  const Bytes in = packets(1, 100);
  Bytes out;
  injector.push(in.data(), 60, out);
  EXPECT_TRUE(out.empty());
  EXPECT_TRUE(injector.has_pending());
  injector.push(&in[60], in.size() - 60, out);
  EXPECT_EQ(out, in);
  injector.push(in.data(), 60, out);
  injector.flush(out);
  EXPECT_EQ(out.size(), in.size() + 60);
  injector.push(in.data(), 60, out);
  injector.clear();
  EXPECT_FALSE(injector.has_pending());
}

TEST(FaultInjector, HasNames) {
  for (int i = 0; i < sim::kNumLineFaults; ++i) {
    const auto fault = static_cast<LineFault>(i);
    EXPECT_EQ(sim::find_line_fault(sim::name(fault)), fault);
  }
  EXPECT_FALSE(sim::find_line_fault("flips"));
}

// A board behind a faulty line, in simulated time.

class FaultyBoardTest : public testing::Test {
 protected:
  /// Sends `size` bytes at once on demand, and accepts as many as it is told to.
  struct Plain : sim::Board {
    void reset() override { ++resets; }
    std::size_t receive(const std::uint8_t* bytes, std::size_t size) override {
      size = std::min(size, takes);
      got.insert(got.end(), bytes, bytes + size);
      return size;
    }
    std::size_t transmit(std::uint8_t* bytes, std::size_t size) override {
      size = std::min(size, has);
      std::fill_n(bytes, size, std::uint8_t{9});
      has -= size;
      return size;
    }
    void feed(const sim::GreyPair&) override {}
    void run(std::chrono::microseconds) override {}
    int resets = 0;
    std::size_t takes = 1000, has = 0;
    Bytes got;
  };

  void make(const sim::FaultyBoard::Options& options) {
    auto inner = std::make_unique<Plain>();
    plain = inner.get();
    board = std::make_unique<sim::FaultyBoard>(std::move(inner), options);
  }
  std::size_t take(std::size_t size = 100000) {
    Bytes bytes(size);
    return board->transmit(bytes.data(), size);
  }
  std::size_t give(std::size_t size) {
    const Bytes bytes(size, 1);
    return board->receive(bytes.data(), size);
  }

  Plain* plain = nullptr;
  std::unique_ptr<sim::FaultyBoard> board;
};

TEST_F(FaultyBoardTest, AStallHoldsBothDirectionsAndLosesNothing) {
  make({});
  plain->has = 500;
  board->stall(std::chrono::milliseconds(30));
  EXPECT_EQ(take(), 0U);
  EXPECT_EQ(give(10), 0U);
  board->run(std::chrono::milliseconds(29));
  EXPECT_EQ(take(), 0U);
  board->run(std::chrono::milliseconds(1));
  EXPECT_EQ(take(), 500U);
  EXPECT_EQ(give(10), 10U);
  EXPECT_EQ(plain->got.size(), 10U);
  EXPECT_EQ(board->counts().stalls, 1U);
}

TEST_F(FaultyBoardTest, LimitsTheRateOfASlowHost) {
  sim::FaultyBoard::Options options;
  options.bytes_per_s = 100000;
  make(options);
  plain->has = 50000;
  std::size_t taken = 0;
  for (int ms = 0; ms < 100; ++ms) {
    board->run(std::chrono::milliseconds(1));
    taken += take();
  }
  EXPECT_EQ(taken, 10000U);
}

TEST_F(FaultyBoardTest, AResetDropsBytesInFlight) {
  make({});
  board->reset_soon();
  EXPECT_EQ(take(), 0U);
  EXPECT_EQ(plain->resets, 0);
  plain->has = 100;
  EXPECT_EQ(take(100), 50U);
  EXPECT_EQ(plain->resets, 1);
  board->reset_soon();
  board->run(std::chrono::milliseconds(1001));
  EXPECT_EQ(plain->resets, 2);
  EXPECT_EQ(board->counts().resets, 2U);
}

TEST_F(FaultyBoardTest, ABusyBoardMakesTheHostWait) {
  make({});
  plain->takes = 0;
  std::size_t given = 0;
  for (int i = 0; i < 20; ++i) given += give(10000);
  EXPECT_LT(given, 100000U);
  EXPECT_GT(given, 60000U);
  plain->takes = 1000000;
  board->run(std::chrono::milliseconds(1));
  EXPECT_EQ(plain->got.size(), given);
}

TEST_F(FaultyBoardTest, CountsBytesThatNobodyReads) {
  make({});
  plain->has = 300;
  board->discard();
  EXPECT_EQ(take(), 0U);
  EXPECT_EQ(board->counts().lost, 300U);
}

}  // namespace
}  // namespace fpga_stereo::test
