// FTDI's synchronous 245 FIFO as the FPGA sees it: FT232H and FT601, written from the timing
// diagrams of AN_130, DS_FT232H and DS_FT600Q-FT601Q. Every rule that is broken is an error.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <deque>
#include <random>
#include <type_traits>
#include <vector>

namespace fpga_stereo::test {

/// When RXF# or TXE# is high although there is something, or room.
enum class Stalls {
  kNone,
  kGlitches,   // single clocks
  kRandom,     // any number of clocks
  kAlternate,  // every other clock
  kPackets,    // 10 clocks after 510 words
  kAlways,
};

/// The chip on the pins of `Model`: fs_ft245 or fs_link_usb.
template <class Model>
class Ft245Chip {
 public:
  using Word = std::decay_t<decltype(Model::data_o)>;
  static constexpr int kBytes = sizeof(Word);

  explicit Ft245Chip(Model& model, unsigned seed) : model_(model), random_(seed) { outputs(); }

  /// Bytes that the host sends and the FPGA has not yet read; with the FT601 as many of them in a
  /// word as `keep` has ones.
  void give(Word data, int keep = (1 << kBytes) - 1) { to_fpga_.push_back({data, keep}); }
  std::size_t waiting() const { return to_fpga_.size(); }

  /// Right before a rising edge: the chip takes what the FPGA shows.
  void before_edge() {
    const bool rd = !model_.rd_no, wr = !model_.wr_no, oe = !model_.oe_no,
               drives = model_.data_oe_o;
    ASSERT_FALSE(drives && oe) << "both drive the bus";
    ASSERT_FALSE(drives && oe_) << "the FPGA drives while the chip still lets go";
    ASSERT_FALSE(oe && drives_) << "the chip drives while the FPGA still lets go";
    ASSERT_FALSE(rd && !(oe && oe_)) << "RD# without OE# a clock before";
    ASSERT_FALSE(wr && !drives) << "WR# without data";
    ASSERT_FALSE(wr_ && !wr && !drives) << "data gone with WR#: no hold time";
    idle_reads_ = rd && model_.rxf_ni ? idle_reads_ + 1 : 0;
    idle_writes_ = wr && model_.txe_ni ? idle_writes_ + 1 : 0;
    ASSERT_LE(idle_reads_, 2) << "RD# stays low though RXF# is high";
    ASSERT_LE(idle_writes_, 2) << "WR# stays low though TXE# is high";
    read = rd && !model_.rxf_ni;
    wrote = wr && !model_.txe_ni;
    if (read) to_fpga_.pop_front();
    if (wrote) {
      ASSERT_EQ(model_.be_o, (1 << kBytes) - 1);
      from_fpga.push_back(model_.data_o);
    }
    rd_ = rd, wr_ = wr, oe_ = oe, drives_ = drives;
    ++clocks;
  }

  /// Behind the edge: the chip's new outputs. To be called when the FPGA's have settled.
  void after_edge() {
    since_read_ = read ? since_read_ + 1 : since_read_;
    since_write_ = wrote ? since_write_ + 1 : since_write_;
    rxf_stall_ = stalled(read_stalls, rxf_stall_, since_read_);
    txe_stall_ = stalled(write_stalls, txe_stall_, since_write_);
    outputs();
  }

  Stalls read_stalls = Stalls::kNone, write_stalls = Stalls::kNone;
  std::vector<Word> from_fpga;
  bool read = false, wrote = false;  // at the last edge
  int clocks = 0;

 private:
  struct Given {
    Word data;
    int keep;
  };

  /// Clocks for which a flag stays high.
  int stalled(Stalls kind, int left, int& words) {
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
    // Behind a clock, OE# lets the chip drive at once; else, and with RXF# high, nothing is on the
    // bus that means anything.
    const bool there = !model_.oe_no && !model_.rxf_ni;
    model_.data_i = there ? to_fpga_.front().data : static_cast<Word>(random_());
    model_.be_i = (kBytes == 1) ? 1
                  : there       ? to_fpga_.front().keep
                                : static_cast<int>(random_() % 16);
  }

  Model& model_;
  std::mt19937 random_;
  std::deque<Given> to_fpga_;
  bool rd_ = false, wr_ = false, oe_ = false, drives_ = false;  // at the edge before
  int idle_reads_ = 0, idle_writes_ = 0;
  int rxf_stall_ = 0, txe_stall_ = 0;
  int since_read_ = 0, since_write_ = 0;
};

}  // namespace fpga_stereo::test
