// Finding and opening boards on USB, and the error messages when that fails.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include "fpga_stereo/link/device.hpp"
#include "link/hotplug_watch.hpp"
#include "link/transport_suite.hpp"
#include "link/usb.hpp"
#include "link/usb_line.hpp"

namespace fpga_stereo::test {
namespace {

using Clock = std::chrono::steady_clock;
using Options = sim::VirtualFt232h::Options;

Options options_of(const char* serial_number, const char* port, const char* product = "board") {
  Options options;
  options.serial_number = serial_number;
  options.port = port;
  options.product = product;
  return options;
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

TEST(Usb, SetsTheChipUp) {
  UsbLine line(options_of("FS7", "1-2.3"));
  const auto transport = open_usb();
  ASSERT_TRUE(transport);
  EXPECT_EQ(transport->description(), "USB 1-2.3, serial number FS7");
  expect_bytes(line, *transport, 1000, 1);
  const auto seen = line.chip.seen();
  EXPECT_EQ(seen.bit_mode, 0x40);
  EXPECT_EQ(seen.latency_ms, 2);
  EXPECT_EQ(seen.flow_control, 0x0100);
  EXPECT_EQ(seen.resets, 1);
  EXPECT_EQ(seen.purges, 2);
  EXPECT_LE(seen.max_pending, 16U);
  EXPECT_GE(seen.max_pending, 12U);  // early ones may end before the last begins
  EXPECT_EQ(seen.urb_bytes, 65536U);
}

TEST(Usb, RefusesAChipThatIsNotAFifo) {
  for (const int mode : {0, 0xFFFF}) {
    Options options;
    options.eeprom_mode = static_cast<std::uint16_t>(mode);
    UsbLine line(options);
    for (const char* name : {"usb", "usb:port=1-1"}) {
      const Error error = error_of(name);
      EXPECT_EQ(error.kind, name == std::string("usb") ? ErrorKind::kNotFound : ErrorKind::kIo);
      says(error, mode == 0 ? "is not set to 245 FIFO mode" : "blank EEPROM");
      says(error, "FT_Prog");
    }
  }
}

TEST(Usb, LeavesOtherChipsToTheirDrivers) {
  Options other = options_of("FT0", "1-1", "serial adapter");
  other.eeprom_mode = 0;
  UsbLine adapter(other);
  adapter.chip.refuse_claims(EBUSY);
  says(error_of("usb"), "serial number FT0 at port 1-1 (it is not set to 245 FIFO mode");
  UsbLine board(options_of("FS7", "1-4"));
  const auto transport = open_usb();
  ASSERT_TRUE(transport);
  EXPECT_EQ(transport->description(), "USB 1-4, serial number FS7");
  EXPECT_EQ(adapter.chip.seen().resets, 0);
}

TEST(Usb, RefusesAChipThatIgnoresItsSetUp) {
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
    const auto transport = open_usb(name);
    ASSERT_TRUE(transport);
    EXPECT_EQ(transport->description(), "USB 1-2.3, serial number FS7") << name;
  }
  for (const char* name : {"usb:serial=FS70", "usb:port=1-3", "usb:match=FS7.", "usb:match=^boa"}) {
    const auto transport = open_usb(name);
    ASSERT_TRUE(transport);
    EXPECT_EQ(transport->description(), "USB 1-3, serial number FS70") << name;
  }
  for (const char* name : {"usb:serial=FS", "usb:port=1-2", "usb:match=XYZ"}) {
    const Error error = error_of(name);
    EXPECT_EQ(error.kind, ErrorKind::kNotFound);
    says(error, "found: serial number FS7 at port 1-2.3; serial number FS70 at port 1-3");
  }
  const auto found = link::list_usb();
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "usb:port=1-2.3");
  EXPECT_EQ(found[0].description, "left board, serial number FS7 at port 1-2.3");
  EXPECT_EQ(error_of("usb:match=(").kind, ErrorKind::kInvalid);

  // Two open boards must not disturb each other.
  const auto one = open_usb("usb:serial=FS7"), other = open_usb("usb:serial=FS70");
  ASSERT_TRUE(one && other);
  expect_bytes(first, *one, 70000, 1);
  expect_bytes(second, *other, 70000, 2);
}

TEST(Usb, EscapesWhatADeviceSaysAboutItself) {
  const UsbLine line(options_of("\x1b]0;x\x07", "1-2.3", "\x1b[2Jboard\r\xff"));
  const auto devices = link::list_devices();
  const auto found = std::find_if(devices.begin(), devices.end(), [](const auto& device) {
    return device.name == "usb:port=1-2.3";
  });
  ASSERT_NE(found, devices.end());
  EXPECT_EQ(found->description, "\\x1b[2Jboard\\x0d?, serial number \\x1b]0;x\\x07 at port 1-2.3");
  const auto transport = open_usb("usb:serial=\\x1b]0;x\\x07");
  ASSERT_TRUE(transport);
  EXPECT_EQ(transport->description(), "USB 1-2.3, serial number \\x1b]0;x\\x07");
  says(error_of("usb:serial=other"), "found: serial number \\x1b]0;x\\x07 at port 1-2.3");
}

TEST(Usb, NamesWhatIsMissing) {
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
  // Only as another user: root may open every device.
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
  EXPECT_TRUE(open_usb());
}

TEST(Usb, FailsIfUnpluggedWhileOpening) {
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

TEST(Usb, ADeviceOpensABoardAsSoonAsItIsPluggedIn) {
  UsbLine line;
  link::Device::Options options;
  options.open = [] { return link::open_transport("usb"); };
  options.hotplug = link::watch_for("usb");
  options.retry = std::chrono::minutes(5);
  link::Device::Callbacks callbacks;
  callbacks.note = [](const std::string&) {};
  link::Device device(options, callbacks);
  const auto wait_for = [&](bool open, std::uint64_t times) {
    const auto deadline = Clock::now() + Milliseconds(10000);
    while (Clock::now() < deadline) {
      const link::Device::Snapshot now = device.snapshot();
      if (now.description.empty() != open && now.times_opened >= times) return true;
      std::this_thread::sleep_for(Milliseconds(1));
    }
    return false;
  };
  ASSERT_TRUE(wait_for(true, 1));
  for (std::uint64_t i = 2; i < 10; ++i) {
    line.unplug();
    ASSERT_TRUE(wait_for(false, i - 1));
    std::this_thread::sleep_for(Milliseconds(i * 3));
    line.plug();
    ASSERT_TRUE(wait_for(true, i)) << device.snapshot().trouble_text;
  }
}

/// Runs in a process of its own, started by the test below.
TEST(UsbChild, DISABLED_Echoes) {
  const auto transport = open_usb();
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
