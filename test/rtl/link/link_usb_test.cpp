// fs_link_usb across its two clocks: words from the core reach the host as bytes, and bytes from
// the host reach the core.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "LinkUsb32.h"
#include "LinkUsb8.h"
#include "rtl/link/ft245_chip.hpp"
#include "rtl/link/two_clocks.hpp"

namespace fpga_stereo::test {
namespace {

template <class Model>
class UsbRig {
 public:
  static constexpr int kBytes = Ft245Chip<Model>::kBytes;

  UsbRig(int period, int usb_period, unsigned seed)
      : clocks(period, usb_period, 2, seed), random(seed), chip(model, seed) {
    reset();
  }

  void reset() {
    model.rst_ni = 0;
    run(60);
    model.rst_ni = 1;
    run(60);
    sent_by_fpga.clear(), sent_by_host.clear(), received_by_fpga.clear(), chip.from_fpga.clear();
  }

  void run(int edges) {
    for (int i = 0; i < edges && !testing::Test::HasFailure(); ++i) step();
  }

  /// Queues a word to the host and records its bytes.
  void put(std::uint32_t word) {
    words_.push_back(word);
    for (int i = 0; i < 4; ++i) sent_by_fpga.push_back(static_cast<std::uint8_t>(word >> 8 * i));
  }
  /// Queues random bytes from the host and records them.
  void give() {
    const int keep = kBytes == 1 ? 1 : static_cast<int>(random() % 16);
    const std::uint32_t word = random();
    for (int i = 0; i < kBytes; ++i) {
      if ((keep >> i & 1) != 0) sent_by_host.push_back(static_cast<std::uint8_t>(word >> 8 * i));
    }
    chip.give(static_cast<typename Ft245Chip<Model>::Word>(word), keep);
  }
  /// Returns the bytes that the host has read.
  std::vector<std::uint8_t> received_by_host() const {
    std::vector<std::uint8_t> bytes;
    for (const auto word : chip.from_fpga) {
      for (int i = 0; i < kBytes; ++i) bytes.push_back(static_cast<std::uint8_t>(word >> 8 * i));
    }
    return bytes;
  }

  Model model;
  TwoClocks clocks;
  std::mt19937 random;
  Ft245Chip<Model> chip;
  std::vector<std::uint8_t> sent_by_fpga, sent_by_host, received_by_fpga;
  double rx_chance = 1;
  bool usb_runs = true;

 private:
  void step() {
    const int edges = clocks.next() & (usb_runs ? 3 : 1);
    model.eval();
    const bool is_sent = (edges & 1) && model.tx_valid_i && model.tx_ready_o;
    if ((edges & 1) && model.rx_valid_o && model.rx_ready_i)
      received_by_fpga.push_back(model.rx_data_o);
    if (edges & 2) chip.before_edge();
    model.clk_i = edges & 1;
    model.usb_clk_i = edges >> 1;
    model.eval();
    model.clk_i = model.usb_clk_i = 0;
    if (edges & 1) {
      if (is_sent) ++next_;
      model.tx_valid_i = next_ < words_.size();
      model.tx_data_i = next_ < words_.size() ? words_[next_] : 0;
      model.rx_ready_i = random() < rx_chance * 4294967296.;
    }
    if (edges & 2) chip.after_edge();
  }

  std::vector<std::uint32_t> words_;
  std::size_t next_ = 0;
};

template <class Model>
class RtlLinkUsb : public testing::Test {};
using Links = testing::Types<LinkUsb8, LinkUsb32>;
TYPED_TEST_SUITE(RtlLinkUsb, Links);

TYPED_TEST(RtlLinkUsb, PassesAllBytesUnchanged) {
  const Stalls stalls[] = {Stalls::kNone, Stalls::kGlitches, Stalls::kRandom, Stalls::kPackets};
  for (const auto& [period, usb_period] : {std::pair{40, 50}, {100, 60}, {31, 97}}) {
    UsbRig<TypeParam> rig(period, usb_period, period);
    for (int i = 0; i < 20; ++i) {
      SCOPED_TRACE(testing::Message() << period << ":" << usb_period << ", " << i);
      for (int k = 0; k < 300; ++k) rig.put(rig.random());
      for (int k = 0; k < 800; ++k) rig.give();
      rig.chip.read_stalls = stalls[rig.random() % 4];
      rig.chip.write_stalls = stalls[rig.random() % 4];
      rig.rx_chance = i % 3 == 0 ? 0.3 : 1;
      for (int k = 0; k < 60; ++k) {
        if (rig.received_by_fpga.size() == rig.sent_by_host.size() &&
            rig.received_by_host().size() == rig.sent_by_fpga.size())
          break;
        rig.run(1000);
      }
      ASSERT_EQ(rig.received_by_host(), rig.sent_by_fpga);
      ASSERT_EQ(rig.received_by_fpga, rig.sent_by_host);
    }
  }
}

TYPED_TEST(RtlLinkUsb, AResetDiscardsEarlierBytes) {
  UsbRig<TypeParam> rig(50, 60, 7);
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    rig.reset();
    for (int k = 0; k < 20; ++k) rig.put(rig.random()), rig.give();
    rig.run(900);
    ASSERT_EQ(rig.received_by_host(), rig.sent_by_fpga);
    ASSERT_EQ(rig.received_by_fpga, rig.sent_by_host);
    // The next reset hits with some of these bytes inside the module and none left at either end.
    for (int k = 0; k < 20; ++k) rig.put(rig.random()), rig.give();
    for (int k = 0; rig.model.tx_valid_i && k < 100; ++k) rig.run(1);
    rig.run(static_cast<int>(rig.random() % 90));
    rig.rx_chance = 1;
    for (int k = 0; k < 10000 && (rig.chip.waiting() > 0 || rig.model.tx_valid_i); ++k) rig.run(1);
    ASSERT_FALSE(rig.chip.waiting() > 0 || rig.model.tx_valid_i || this->HasFailure());
  }
}

TYPED_TEST(RtlLinkUsb, AStoppedUsbClockLosesNothing) {
  UsbRig<TypeParam> rig(50, 60, 9);
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 100; ++k) rig.put(rig.random()), rig.give();
    rig.run(static_cast<int>(rig.random() % 200));
    rig.usb_runs = false;
    rig.run(500);
    rig.usb_runs = true;
    rig.run(2500);
    ASSERT_EQ(rig.received_by_host(), rig.sent_by_fpga);
    ASSERT_EQ(rig.received_by_fpga, rig.sent_by_host);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
