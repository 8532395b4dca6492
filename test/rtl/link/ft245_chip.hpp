// Models the synchronous 245 FIFO of FTDI's FT232H and FT601 as the FPGA sees it, after the timing
// diagrams of AN_130, DS_FT232H and DS_FT600Q-FT601Q. A broken bus rule fails the test.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <random>
#include <type_traits>
#include <vector>

namespace fpga_stereo::test {

/// When RXF# or TXE# is high although the chip has data or space.
enum class Stalls {
  kNone,
  kGlitches,   // single clocks
  kRandom,     // any number of clocks
  kAlternate,  // every other clock
  kPackets,    // 10 clocks after 510 words
  kAlways,
};

/// The chip connected to the ports of `Model`: fs_ft245, fs_link_usb or board_pins.
template <class Model>
class Ft245Chip {
 public:
  using Word = std::decay_t<decltype(Model::data_o)>;
  static constexpr int kBytes = sizeof(Word);

  explicit Ft245Chip(Model& model, unsigned seed) : model_(model), random_(seed) { outputs(); }

  /// Queues a word that the host sends to the FPGA. `keep` has a bit for each byte: 1 = valid.
  void give(Word data, int keep = (1 << kBytes) - 1) { to_fpga_.push_back({data, keep}); }
  /// Returns the number of words that the FPGA has not read yet.
  std::size_t waiting() const { return to_fpga_.size(); }

  /// Samples and checks the FPGA's outputs. Call it right before each rising edge of the clock.
  void before_edge() {
    const bool rd = !model_.rd_no, wr = !model_.wr_no, oe = !model_.oe_no,
               drives = model_.data_oe_o;
    ASSERT_FALSE(drives && oe) << "the FPGA and the chip both drive the bus";
    ASSERT_FALSE(drives && was_enabled_)
        << "the FPGA drives the bus before the chip has released it";
    ASSERT_FALSE(oe && fpga_drove_) << "the chip drives the bus before the FPGA has released it";
    ASSERT_FALSE(rd && !(oe && was_enabled_)) << "RD# is low but OE# was not low one clock earlier";
    ASSERT_FALSE(wr && !drives) << "WR# is low but the FPGA does not drive the bus";
    ASSERT_FALSE(was_writing_ && !wr && !drives)
        << "the FPGA released the bus together with WR#: no hold time";
    idle_reads_ = rd && model_.rxf_ni ? idle_reads_ + 1 : 0;
    idle_writes_ = wr && model_.txe_ni ? idle_writes_ + 1 : 0;
    ASSERT_LE(idle_reads_, 2) << "RD# stays low while RXF# is high";
    ASSERT_LE(idle_writes_, 2) << "WR# stays low while TXE# is high";
    read = rd && !model_.rxf_ni;
    wrote = wr && !model_.txe_ni;
    if (read) to_fpga_.pop_front();
    if (wrote) {
      ASSERT_EQ(model_.be_o, (1 << kBytes) - 1);
      from_fpga.push_back(model_.data_o);
    }
    was_reading_ = rd, was_writing_ = wr, was_enabled_ = oe, fpga_drove_ = drives;
    ++clocks;
  }

  /// Sets the chip's outputs. Call it after each rising edge, once the FPGA's outputs have settled.
  void after_edge() {
    since_read_ = read ? since_read_ + 1 : since_read_;
    since_write_ = wrote ? since_write_ + 1 : since_write_;
    rxf_stall_ = stall_clocks(read_stalls, rxf_stall_, since_read_);
    txe_stall_ = stall_clocks(write_stalls, txe_stall_, since_write_);
    outputs();
  }

  Stalls read_stalls = Stalls::kNone, write_stalls = Stalls::kNone;
  std::vector<Word> from_fpga;
  bool read = false, wrote = false;  // whether a word moved at the last edge
  int clocks = 0;

 private:
  struct HostWord {
    Word data;
    int keep;
  };

  /// Returns for how many more clocks a flag stays high, given its remaining clocks `left`.
  int stall_clocks(Stalls kind, int left, int& words) {
    switch (kind) {
      case Stalls::kNone:
        return 0;
      case Stalls::kGlitches:
        return random_() % 8 == 0;
      case Stalls::kAlternate:
        return left == 0;
      case Stalls::kAlways:
        return 1;
      case Stalls::kRandom:
        if (left > 0) return left - 1;
        return random_() % 16 == 0 ? 1 + static_cast<int>(random_() % 20) : 0;
      case Stalls::kPackets:
        if (left > 0) return left - 1;
        if (words < 510) return 0;
        words = 0;
        return 10;
    }
    return 0;
  }

  void outputs() {
    model_.rxf_ni = to_fpga_.empty() || rxf_stall_ > 0;
    model_.txe_ni = txe_stall_ > 0;
    // OE# enables the chip's drivers without delay. Otherwise, or while RXF# is high, the bus
    // carries no meaningful data.
    const bool has_data = !model_.oe_no && !model_.rxf_ni;
    model_.data_i = has_data ? to_fpga_.front().data : static_cast<Word>(random_());
    model_.be_i = (kBytes == 1) ? 1
                  : has_data    ? to_fpga_.front().keep
                                : static_cast<int>(random_() % 16);
  }

  Model& model_;
  std::mt19937 random_;
  std::deque<HostWord> to_fpga_;
  bool was_reading_ = false, was_writing_ = false, was_enabled_ = false,
       fpga_drove_ = false;  // at the previous edge
  int idle_reads_ = 0, idle_writes_ = 0;
  int rxf_stall_ = 0, txe_stall_ = 0;
  int since_read_ = 0, since_write_ = 0;
};

}  // namespace fpga_stereo::test
