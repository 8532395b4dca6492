#include "link/usb_line.hpp"

#include <gtest/gtest.h>

#include "link/hotplug_watch.hpp"
#include "link/transport_suite.hpp"

namespace fpga_stereo::test {

UsbLine::UsbLine(const sim::VirtualFt232h::Options& options) : chip(*this, options) {
  // Holds libusb's monitor open until the program ends: umockdev aborts if a monitor is closed
  // while umockdev has an event for it.
  static const link::HotplugWatch monitor;
}

std::unique_ptr<link::Transport> open_usb(const std::string& name) {
  auto opened = link::open_transport(name);
  EXPECT_TRUE(opened) << opened.error().message;
  return opened ? std::move(*opened) : nullptr;
}

void expect_bytes(UsbLine& line, link::Transport& transport, std::size_t size, unsigned seed) {
  const Bytes sent = random_bytes(size, seed);
  line.send(sent);
  EXPECT_TRUE(read_all(transport, size) == sent) << "seed " << seed;
  EXPECT_EQ(write_all(transport, sent), size);
  EXPECT_TRUE(line.take(size) == sent) << "seed " << seed;
}

}  // namespace fpga_stereo::test
