// The USB transport on an emulated FT232H: what every transport does, and what this chip adds.
#include "fpga_stereo/link/usb.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
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

Options options_of(const char* serial_number, const char* port, const char* product = "board") {
  Options options;
  options.serial_number = serial_number;
  options.port = port;
  options.product = product;
  return options;
}

std::unique_ptr<Transport> open(const std::string& name = "usb") {
  auto opened = link::open_transport(name);
  EXPECT_TRUE(opened) << opened.error().message;
  return opened ? std::move(*opened) : nullptr;
}

Error error_of(const std::string& name) {
  const auto opened = link::open_transport(name);
  EXPECT_FALSE(opened) << name;
  return opened ? Error{} : opened.error();
}

bool says(const Error& error, const std::string& text) {
  if (error.message.find(text) != std::string::npos) return true;
  ADD_FAILURE() << "'" << error.message << "' does not say '" << text << "'";
  return false;
}

void expect_bytes(UsbLine& line, Transport& transport, std::size_t size, unsigned seed) {
  const Bytes sent = random_bytes(size, seed);
  line.send(sent);
  EXPECT_TRUE(read_all(transport, size) == sent) << "seed " << seed;
  EXPECT_EQ(write_all(transport, sent), size);
  EXPECT_TRUE(line.take(size) == sent) << "seed " << seed;
}

/// The data may be there before the halt is counted.
std::uint64_t stalls(const Transport& transport, std::uint64_t expected) {
  for (int i = 0; i < 1000 && transport.counters().stalls < expected; ++i) {
    std::this_thread::sleep_for(Milliseconds(1));
  }
  return transport.counters().stalls;
}

TEST(Usb, SetsTheChipUp) {
  UsbLine line(options_of("FS7", "1-2.3"));
  const auto transport = open();
  ASSERT_TRUE(transport);
  EXPECT_EQ(transport->description(), "USB 1-2.3, serial number FS7");
  expect_bytes(line, *transport, 1000, 1);
  const auto seen = line.chip.seen();
  EXPECT_EQ(seen.bit_mode, 0x40);
  EXPECT_EQ(seen.latency_ms, 2);
  EXPECT_EQ(seen.flow_control, 0x0100);
  EXPECT_EQ(seen.resets, 1);
  EXPECT_EQ(seen.purges, 2);
  EXPECT_LE(seen.most_pending, 16U);
  EXPECT_GE(seen.most_pending, 12U);  // some may end while the others begin
  EXPECT_EQ(seen.urb_bytes, 65536U);
}

TEST(Usb, PacketsOfAllSizes) {
  for (const bool high_speed : {true, false}) {
    Options options;
    options.high_speed = high_speed;
    UsbLine line(options);
    const auto transport = open();
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

TEST(Usb, RefusesAChipThatIsNoFifo) {
  for (const int mode : {0, 0xFFFF}) {
    Options options;
    options.eeprom_mode = static_cast<std::uint16_t>(mode);
    UsbLine line(options);
    const Error error = error_of("usb");
    EXPECT_EQ(error.kind, ErrorKind::kIo);
    says(error, mode == 0 ? "is not set to 245 FIFO mode" : "blank EEPROM");
    says(error, "FT_Prog");
  }
}

TEST(Usb, RefusesAChipThatDoesNotObey) {
  {
    UsbLine line;
    line.chip.keep_latency(16);
    says(error_of("usb"), "latency timer was set to 2 ms and reads back as 16 ms");
  }
  for (const std::uint8_t request : {0x00, 0x02, 0x09, 0x0A, 0x0B, 0x90}) {
    UsbLine line;
    line.chip.fail_request(request);
    const Error error = error_of("usb");
    EXPECT_EQ(error.kind, ErrorKind::kIo);
    says(error, "request " + std::to_string(request));
  }
}

TEST(Usb, SelectsOneOfTwo) {
  UsbLine first(options_of("FS7", "1-2.3", "left board")), second(options_of("FS70", "1-3"));
  for (const char* name :
       {"usb", "usb:serial=FS7", "usb:port=1-2.3", "usb:match=^left", "usb:match=S7$"}) {
    const auto transport = open(name);
    ASSERT_TRUE(transport);
    EXPECT_EQ(transport->description(), "USB 1-2.3, serial number FS7") << name;
  }
  for (const char* name : {"usb:serial=FS70", "usb:port=1-3", "usb:match=FS7.", "usb:match=^boa"}) {
    const auto transport = open(name);
    ASSERT_TRUE(transport);
    EXPECT_EQ(transport->description(), "USB 1-3, serial number FS70") << name;
  }
  for (const char* name : {"usb:serial=FS", "usb:port=1-2", "usb:match=XYZ"}) {
    const Error error = error_of(name);
    EXPECT_EQ(error.kind, ErrorKind::kNotFound);
    says(error, "there are: serial number FS7 at port 1-2.3; serial number FS70 at port 1-3");
  }
  const auto found = link::list_usb();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "usb:port=1-2.3");
  EXPECT_EQ(found[0].description, "left board, serial number FS7 at port 1-2.3");
  EXPECT_EQ(error_of("usb:match=(").kind, ErrorKind::kInvalid);

  // Two boards at once do not disturb each other.
  const auto one = open("usb:serial=FS7"), other = open("usb:serial=FS70");
  ASSERT_TRUE(one && other);
  expect_bytes(first, *one, 70000, 1);
  expect_bytes(second, *other, 70000, 2);
}

TEST(Usb, SaysWhatIsMissing) {
  {
    UsbLine line;
    line.unplug();
    const Error error = error_of("usb");
    EXPECT_EQ(error.kind, ErrorKind::kNotFound);
    says(error, "0403:6014");
  }
  UsbLine line;
  line.chip.refuse_claims(EBUSY);
  EXPECT_EQ(error_of("usb").kind, ErrorKind::kBusy);
  line.chip.refuse_claims(0);
  // Root may open everything.
  line.chip.permit(false);
  const bool root = geteuid() == 0;
  ASSERT_EQ(root ? seteuid(65534) : 0, 0);
  const Error first = error_of("usb"), serial = error_of("usb:serial=FS000001");
  ASSERT_EQ(root ? seteuid(0) : 0, 0);
  for (const auto& error : {first, serial}) {
    EXPECT_EQ(error.kind, ErrorKind::kPermission);
    says(error, "70-fpga-stereo.rules");
  }
  line.chip.permit(true);
  EXPECT_TRUE(open());
}

TEST(Usb, OvercomesHalts) {
  UsbLine line;
  const auto transport = open();
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

TEST(Usb, EndlessHaltsAreAnErrorUntilRecovery) {
  UsbLine line;
  const auto transport = open();
  ASSERT_TRUE(transport);
  line.chip.fail_every_in(-EPROTO);
  std::uint8_t byte = 0;
  const auto got = transport->read(&byte, 1, Milliseconds(5000));
  ASSERT_FALSE(got);
  EXPECT_EQ(got.error().kind, ErrorKind::kIo);
  says(got.error(), "halts again and again");
  EXPECT_FALSE(transport->read(&byte, 1, Milliseconds(0)));
  line.chip.fail_every_in(0);
  EXPECT_TRUE(transport->recover(Recovery::kPurge));
  expect_bytes(line, *transport, 1000, 5);
}

TEST(Usb, CountsOverruns) {
  UsbLine line;
  const auto transport = open();
  ASSERT_TRUE(transport);
  line.chip.report_overrun();
  expect_bytes(line, *transport, 10000, 1);
  EXPECT_EQ(transport->counters().stalls, 1U);
}

TEST(Usb, WhatWaitsIsBounded) {
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
  EXPECT_LE(line.chip.seen().most_pending, 4U);
  EXPECT_EQ(line.chip.seen().urb_bytes, 8192U);
  EXPECT_GE(line.waiting(), sent.size() - 65536);
  EXPECT_TRUE(read_all(**transport, sent.size()) == sent);
}

TEST(Usb, UnpluggedWhileItIsOpened) {
  UsbLine line;
  line.chip.hold_requests(true);
  std::thread hand([&] {
    std::this_thread::sleep_for(Milliseconds(20));
    line.unplug();
  });
  const auto begin = Clock::now();
  EXPECT_EQ(error_of("usb").kind, ErrorKind::kNotFound);
  EXPECT_LT(Clock::now() - begin, Milliseconds(5000));
  hand.join();
}

TEST(Usb, UnpluggedInRecovery) {
  UsbLine line;
  const auto transport = open();
  ASSERT_TRUE(transport);
  line.chip.hold_requests(true);
  std::thread hand([&] {
    std::this_thread::sleep_for(Milliseconds(20));
    line.unplug();
  });
  const Status recovered = transport->recover(Recovery::kRestart);
  hand.join();
  ASSERT_FALSE(recovered);
  EXPECT_EQ(recovered.error().kind, ErrorKind::kGone);
}

TEST(Usb, UnpluggedAtAnyTime) {
  std::mt19937 random(1);
  UsbLine line;
  const Bytes sent(200000, 7);
  for (int i = 0; i < 25; ++i) {
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
      EXPECT_TRUE(!got && got.error().kind == ErrorKind::kGone) << "seed 1, round " << i;
      writer.join();
    } else {
      EXPECT_EQ(opened.error().kind, ErrorKind::kNotFound) << opened.error().message;
    }
    hand.join();
    if (i % 2 == 0) opened = Error{};
    line.plug();
  }
}

TEST(Usb, WatchSeesBoardsComeAndGo) {
  UsbLine line;
  link::HotplugWatch watch;
  EXPECT_FALSE(watch.wait(Milliseconds(10)));
  line.unplug();
  EXPECT_TRUE(watch.wait(Milliseconds(5000)));
  EXPECT_FALSE(watch.wait(Milliseconds(0)));
  std::thread hand([&] {
    std::this_thread::sleep_for(Milliseconds(20));
    line.plug();
  });
  EXPECT_TRUE(watch.wait(Milliseconds(5000)));
  hand.join();
  std::thread caller([&] { watch.interrupt(); });
  const auto begin = Clock::now();
  EXPECT_FALSE(watch.wait(Milliseconds(5000)));
  EXPECT_LT(Clock::now() - begin, Milliseconds(2000));
  caller.join();
}

/// Run by the test below, in a process of its own.
TEST(UsbChild, DISABLED_Echoes) {
  const auto transport = open();
  ASSERT_TRUE(transport);
  const Bytes bytes = read_all(*transport, 100000);
  EXPECT_EQ(write_all(*transport, bytes), 100000U);
}

TEST(Usb, AnotherProcessSeesTheBoard) {
  UsbLine line;
  std::string command = "env ASAN_OPTIONS=verify_asan_link_order=0";
  for (const auto& variable : line.chip.environment()) command += " '" + variable + "'";
  command += " '" + std::filesystem::read_symlink("/proc/self/exe").string() +
             "' --gtest_also_run_disabled_tests --gtest_filter=UsbChild.* --gtest_output= >&2";
  const Bytes sent = random_bytes(100000, 1);
  line.send(sent);
  int status = -1;
  std::thread child([&] { status = std::system(command.c_str()); });
  EXPECT_TRUE(line.take(sent.size()) == sent);
  child.join();
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(line.chip.wait_until_closed(Milliseconds(2000)));
}

}  // namespace
}  // namespace fpga_stereo::test
