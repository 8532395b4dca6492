// fs_link_uart on a serial line whose other end has its own clock.
#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "LinkUart.h"

namespace fpga_stereo::test {
namespace {

constexpr double kClockHz = 100e6;

/// The other end of the line. Times are in clocks of the model, with fractions.
class UartLine {
 public:
  UartLine(int baud, double error, double phase)
      : bit_(kClockHz / (baud * (1 + error))), end_(phase), levels_{{true, phase}} {}

  /// Appends a byte to what this end sends; without `stop`, its stop bit is low.
  void send(std::uint8_t byte, bool stop = true) {
    level(false, bit_);
    for (int i = 0; i < 8; ++i) level((byte >> i & 1) != 0, bit_);
    level(stop, bit_);
  }
  /// Appends a level of the line for a time.
  void level(bool value, double clocks) {
    end_ += clocks;
    levels_.push_back({value, end_});
  }
  double bit() const { return bit_; }
  bool done() const { return next_ == levels_.size(); }

  /// Returns the level of the line in this clock.
  bool at(double clock) {
    while (next_ < levels_.size() && levels_[next_].until <= clock) ++next_;
    return next_ == levels_.size() || levels_[next_].value;
  }

  /// Receives from the model: samples each bit in its middle.
  void listen(double clock, bool value) {
    if (!is_receiving_) {
      if (value) return;
      is_receiving_ = true, start_ = clock, bits_ = 0, shift_ = 0;
    }
    if (clock < start_ + (bits_ + 0.5) * bit_) return;
    if (bits_ == 0) {
      ASSERT_FALSE(value) << "start bit is high";
    } else if (bits_ <= 8) {
      shift_ |= value << (bits_ - 1);
    } else {
      ASSERT_TRUE(value) << "stop bit is low";
      received.push_back(static_cast<std::uint8_t>(shift_));
      starts.push_back(start_);
      is_receiving_ = false;
    }
    ++bits_;
  }

  std::vector<std::uint8_t> received;
  std::vector<double> starts;  // clock of each byte's start bit

 private:
  struct Level {
    bool value;
    double until;
  };
  double bit_, end_;
  std::vector<Level> levels_;
  std::size_t next_ = 0;
  bool is_receiving_ = false;
  double start_ = 0;
  int bits_ = 0, shift_ = 0;
};

class UartRig {
 public:
  explicit UartRig(int baud, double error = 0, double phase = 0) : line(baud, error, phase + 20) {
    model.baud_i = baud;
    model.rxd_i = 1;
    model.rx_ready_i = 1;
    for (int i = 0; i < 10; ++i) step();
    model.rst_ni = 1;
  }

  void step() {
    model.rxd_i = line.at(clock);
    model.eval();
    line.listen(clock, model.txd_o);
    if (model.rx_valid_o && model.rx_ready_i) received.push_back(model.rx_data_o);
    const bool is_sent = model.tx_valid_i && model.tx_ready_o;
    model.clk_i = 1;
    model.eval();
    model.clk_i = 0;
    if (is_sent) ++next;
    model.tx_valid_i = next < words.size();
    model.tx_data_i = next < words.size() ? words[next] : 0;
    framing_errors += model.framing_error_o;
    overruns += model.overrun_o;
    ++clock;
  }
  void run(int clocks) {
    for (int i = 0; i < clocks && !testing::Test::HasFailure(); ++i) step();
  }
  /// Runs until the model has received everything that the line sends.
  void finish() {
    while (!line.done()) step();
    run(static_cast<int>(2 * line.bit()) + 20);
  }

  LinkUart model;
  UartLine line;
  std::vector<std::uint32_t> words;
  std::size_t next = 0;
  std::vector<std::uint8_t> received;
  int clock = 0, framing_errors = 0, overruns = 0;
};

struct Rate {
  int baud;
  double error;  // relative error of the other end's clock
  int bytes;
};

class RtlUart : public testing::TestWithParam<Rate> {};

TEST_P(RtlUart, ReceivesBytesBackToBackAtAnyPhase) {
  const Rate rate = GetParam();
  std::mt19937 random(rate.baud);
  for (int phase = 0; phase < 10; ++phase) {
    UartRig rig(rate.baud, rate.error, phase * 0.1);
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < rate.bytes; ++i) {
      const auto byte = static_cast<std::uint8_t>(i < 4 ? (i % 2 == 0 ? 0 : 255) : random());
      bytes.push_back(byte);
      rig.line.send(byte);
      if (random() % 4 == 0) rig.line.level(true, static_cast<double>(random() % 1000) / 100);
    }
    rig.finish();
    ASSERT_EQ(rig.received, bytes) << "phase " << phase;
    EXPECT_EQ(rig.framing_errors, 0);
    EXPECT_EQ(rig.overruns, 0);
  }
}

TEST_P(RtlUart, SendsWordsAsBytesBackToBack) {
  const Rate rate = GetParam();
  UartRig rig(rate.baud, rate.error);
  std::mt19937 random(rate.baud);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < rate.bytes / 4; ++i) {
    const std::uint32_t word = i == 0 ? 0xFF00FF00 : random();
    rig.words.push_back(word);
    for (int k = 0; k < 4; ++k) bytes.push_back(static_cast<std::uint8_t>(word >> 8 * k));
  }
  for (int i = 0; rig.line.received.size() < bytes.size() && i < 4000; ++i) rig.run(1000);
  ASSERT_EQ(rig.line.received, bytes);
  // There is neither gap nor drift: byte k begins 10 k bits after byte 0, within one clock.
  for (std::size_t k = 0; k < bytes.size(); ++k) {
    const double expected =
        rig.line.starts[0] + 10. * static_cast<double>(k) * kClockHz / rate.baud;
    ASSERT_NEAR(rig.line.starts[k], expected, 1.0001) << k;
  }
}

// At 5 Mbit/s a bit has 20 clocks, too few to tolerate an error of 3 %.
INSTANTIATE_TEST_SUITE_P(Rates, RtlUart,
                         testing::Values(Rate{3000000, 0, 400}, Rate{3000000, 0.03, 400},
                                         Rate{3000000, -0.03, 400}, Rate{2999999, 0.01, 100},
                                         Rate{5000000, 0.01, 100}, Rate{115200, 0, 16},
                                         Rate{115200, 0.03, 16}, Rate{115200, -0.03, 16}));

TEST(RtlUartLine, IgnoresGlitchesOnTheIdleLine) {
  UartRig rig(3000000);
  std::mt19937 random(2);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 500; ++i) {
    // The line is low for up to 10 of the 33 clocks of a bit.
    rig.line.level(false, 0.1 + static_cast<double>(random() % 100) / 10);
    rig.line.level(true, 35 + static_cast<double>(random() % 400) / 10);
    if (random() % 2 == 0) continue;
    bytes.push_back(static_cast<std::uint8_t>(random()));
    rig.line.send(bytes.back());
    rig.line.level(true, 10);
  }
  rig.finish();
  EXPECT_EQ(rig.received, bytes);
  EXPECT_EQ(rig.framing_errors, 0);
}

TEST(RtlUartLine, OutvotesAGlitchInTheMiddleOfABit) {
  UartRig rig(115200);
  const double bit = rig.line.bit();
  std::vector<std::uint8_t> bytes;
  for (int value = 0; value < 2; ++value) {
    for (int at = 0; at < 30; ++at) {
      // A byte of all zeros or all ones, inverted for a twentieth of a bit at some place.
      rig.line.level(false, bit);
      const double before = bit * (0.25 + 0.27 * at), glitch = 0.05 * bit;
      rig.line.level(value != 0, before);
      rig.line.level(value == 0, glitch);
      rig.line.level(value != 0, 8 * bit - before - glitch);
      rig.line.level(true, bit);
      bytes.push_back(value != 0 ? 255 : 0);
    }
  }
  rig.finish();
  EXPECT_EQ(rig.received, bytes);
}

TEST(RtlUartLine, DropsAndCountsBytesWithoutAStopBit) {
  UartRig rig(3000000);
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 20; ++i) {
    rig.line.send(static_cast<std::uint8_t>(i), false);
    rig.line.level(true, 50);
    bytes.push_back(static_cast<std::uint8_t>(i + 100));
    rig.line.send(bytes.back());
  }
  rig.finish();
  EXPECT_EQ(rig.received, bytes);
  EXPECT_EQ(rig.framing_errors, 20);
}

TEST(RtlUartLine, CountsABreakOfAnyLengthAsOneError) {
  UartRig rig(3000000);
  for (const double bits : {9.8, 11., 25., 500.}) {
    rig.line.level(false, bits * rig.line.bit());
    rig.line.level(true, 50);
    rig.line.send(0x5A);
    rig.line.send(0xA5);
  }
  rig.finish();
  EXPECT_EQ(rig.received,
            (std::vector<std::uint8_t>{0x5A, 0xA5, 0x5A, 0xA5, 0x5A, 0xA5, 0x5A, 0xA5}));
  EXPECT_EQ(rig.framing_errors, 4);
}

TEST(RtlUartLine, DropsAndCountsBytesWhenTheFifoIsFull) {
  UartRig rig(3000000);
  rig.model.rx_ready_i = 0;
  for (int i = 0; i < 25; ++i) rig.line.send(static_cast<std::uint8_t>(i));
  rig.finish();
  // 16 bytes fit in the FIFO's memory, one in its register and one in the receiver.
  EXPECT_EQ(rig.overruns, 25 - 18);
  rig.model.rx_ready_i = 1;
  rig.run(100);
  std::vector<std::uint8_t> bytes(18);
  std::iota(bytes.begin(), bytes.end(), 0);
  EXPECT_EQ(rig.received, bytes);
}

TEST(RtlUartLine, KeepsTheLineHighInResetAndWhenIdle) {
  LinkUart model;
  model.eval();
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(model.txd_o, 1);
    model.clk_i = 1;
    model.eval();
    model.clk_i = 0;
    model.eval();
  }
  UartRig rig(3000000);
  rig.run(2000);
  EXPECT_TRUE(rig.line.received.empty());
  EXPECT_TRUE(rig.received.empty());
}

}  // namespace
}  // namespace fpga_stereo::test
