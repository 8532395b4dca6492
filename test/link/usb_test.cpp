// The USB transport on a virtual FT232H: the tests of all transports, and the failures of this
// chip.
#include "link/usb.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <random>
#include <thread>

#include "link/transport_suite.hpp"
#include "link/usb_line.hpp"

namespace fpga_stereo::test {
namespace {

using Clock = std::chrono::steady_clock;
using Options = sim::VirtualFt232h::Options;
using link::Recovery;
using link::Transport;

INSTANTIATE_TEST_SUITE_P(Usb, TransportTest,
                         testing::Values(LineKind{"Usb",
                                                  [] { return std::make_unique<UsbLine>(); }}),
                         [](const auto& kind) { return kind.param.name; });

/// Waits for the count, because data may arrive before the halt is counted.
std::uint64_t stalls(const Transport& transport, std::uint64_t expected) {
  for (int i = 0; i < 1000 && transport.counters().stalls < expected; ++i) {
    std::this_thread::sleep_for(Milliseconds(1));
  }
  return transport.counters().stalls;
}

TEST(Usb, CarriesPacketsOfAllSizes) {
  for (const bool high_speed : {true, false}) {
    Options options;
    options.high_speed = high_speed;
    UsbLine line(options);
    const auto transport = open_usb();
    ASSERT_TRUE(transport);
    for (const std::size_t payload : {1, 2, 61, 62, 100, 509, 510}) {
      line.chip.limit_packets(payload);
      expect_bytes(line, *transport, payload * 5 + 1, static_cast<unsigned>(payload));
    }
    line.chip.limit_packets(0);
    line.chip.send_empty(20);
    expect_bytes(line, *transport, 200000, 4);
    EXPECT_EQ(transport->counters().stalls, 0U);
  }
}

TEST(Usb, RecoversFromHalts) {
  UsbLine line;
  const auto transport = open_usb();
  ASSERT_TRUE(transport);
  expect_bytes(line, *transport, 100000, 1);
  line.chip.stall_in();
  expect_bytes(line, *transport, 100000, 2);
  line.chip.fail_in(-EPROTO);
  expect_bytes(line, *transport, 100000, 3);
  EXPECT_EQ(stalls(*transport, 2), 2U);
  line.chip.stall_out();
  expect_bytes(line, *transport, 100000, 4);
  EXPECT_EQ(stalls(*transport, 3), 3U);
  EXPECT_EQ(line.chip.seen().halts_cleared, 3);
}

// As the kernel does between the moment at which a cable is pulled and that at which its hub
// notices.
TEST(Usb, WaitsForTheUnpluggingIfAHaltCannotBeCleared) {
  for (const bool is_pulled : {false, true}) {
    UsbLine line;
    const auto transport = open_usb();
    ASSERT_TRUE(transport);
    line.chip.refuse_clearing(EPROTO);
    line.chip.fail_in(-EPROTO);
    std::thread hand([&] {
      std::this_thread::sleep_for(Milliseconds(60));
      if (is_pulled) line.unplug();
      line.chip.refuse_clearing(0);
    });
    if (is_pulled) {
      std::uint8_t byte = 0;
      const auto got = transport->read(&byte, 1, Milliseconds(5000));
      EXPECT_TRUE(!got && got.error().kind == ErrorKind::kUnplugged) << got.error().message;
    } else {
      expect_bytes(line, *transport, 100000, 6);
    }
    hand.join();
  }
}

TEST(Usb, FailsOnEndlessHaltsUntilRecovery) {
  UsbLine line;
  const auto transport = open_usb();
  ASSERT_TRUE(transport);
  line.chip.fail_every_in(-EPROTO);
  std::uint8_t byte = 0;
  const auto got = transport->read(&byte, 1, Milliseconds(5000));
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().kind, ErrorKind::kIo);
  EXPECT_NE(got.error().message.find("halts again and again"), std::string::npos);
  EXPECT_FALSE(transport->read(&byte, 1, Milliseconds(0)));
  line.chip.fail_every_in(0);
  EXPECT_TRUE(transport->recover(Recovery::kPurge));
  expect_bytes(line, *transport, 1000, 5);
}

TEST(Usb, CountsOverruns) {
  UsbLine line;
  const auto transport = open_usb();
  ASSERT_TRUE(transport);
  line.chip.report_overrun();
  expect_bytes(line, *transport, 10000, 1);
  EXPECT_EQ(transport->counters().stalls, 1U);
}

TEST(Usb, BoundsTheReceiveBuffer) {
  UsbLine line;
  link::UsbOptions options;
  options.transfers = 4;
  options.transfer_bytes = 8000;  // 16 packets
  options.buffer_bytes = 65536;   // 8 transfers
  auto transport = link::open_usb({}, options);
  ASSERT_TRUE(transport) << transport.error().message;
  const Bytes sent = random_bytes(300000, 1);
  line.send(sent);
  std::this_thread::sleep_for(Milliseconds(100));
  EXPECT_LE(line.chip.seen().max_pending, 4U);
  EXPECT_EQ(line.chip.seen().urb_bytes, 8192U);
  EXPECT_GE(line.waiting(), sent.size() - 65536);
  EXPECT_TRUE(read_all(**transport, sent.size()) == sent);
}

TEST(Usb, FailsIfUnpluggedDuringRecovery) {
  UsbLine line;
  const auto transport = open_usb();
  ASSERT_TRUE(transport);
  line.chip.hold_requests(true);
  std::thread hand([&] {
    std::this_thread::sleep_for(Milliseconds(20));
    line.unplug();
  });
  const Status recovered = transport->recover(Recovery::kRestart);
  hand.join();
  ASSERT_FALSE(recovered);
  EXPECT_EQ(recovered.error().kind, ErrorKind::kUnplugged);
}

TEST(Usb, SurvivesUnpluggingAtAnyTime) {
  std::mt19937 random(1);
  UsbLine line;
  const Bytes sent(200000, 7);
  for (int i = 0; i < 20; ++i) {
    const Milliseconds pause(random() % 8);
    std::thread hand([&] {
      std::this_thread::sleep_for(pause);
      line.unplug();
    });
    auto opened = link::open_transport("usb");
    if (opened) {
      Transport& transport = **opened;
      line.send(sent);
      std::thread writer([&] {
        for (int n = 0; n < 100 && transport.write(sent.data(), sent.size(), Milliseconds(500));
             ++n) {
        }
      });
      Bytes bytes(50000);
      auto got = transport.read(bytes.data(), bytes.size(), Milliseconds(2000));
      while (got && *got > 0) {
        got = transport.read(bytes.data(), bytes.size(), Milliseconds(2000));
      }
      EXPECT_TRUE(!got && got.error().kind == ErrorKind::kUnplugged) << "seed 1, round " << i;
      writer.join();
    } else {
      EXPECT_EQ(opened.error().kind, ErrorKind::kNotFound) << opened.error().message;
    }
    hand.join();
    if (i % 2 == 0) opened = Error{};
    line.plug();
  }
}

}  // namespace
}  // namespace fpga_stereo::test
