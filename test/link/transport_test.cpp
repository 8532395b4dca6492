// Transport names, and the tests of all transports over lines that need no USB.
#include "fpga_stereo/link/transport.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "link/test_folder.hpp"
#include "link/transport_suite.hpp"

namespace fpga_stereo::test {
namespace {

INSTANTIATE_TEST_SUITE_P(Lines, TransportTest,
                         testing::Values(LineKind{"Memory", make_memory_line, false},
                                         LineKind{"Pty", make_pty_line}),
                         [](const auto& kind) { return kind.param.name; });

TEST(TransportName, RefusesUnknownNames) {
  for (const char* name : {"",
                           "USB",
                           "usbx",
                           "usb:",
                           "usb:FT5X",
                           "usb:serial",
                           "usb:serial=",
                           "usb:port=12",
                           "usb:port=1-x",
                           "usb:port=-1",
                           "usb:match=",
                           "usb:first=1",
                           "serial",
                           "serial:",
                           "serial::9600",
                           "serial:/dev/ttyS0:0",
                           "serial:/dev/ttyS0:1.5",
                           "serial:/dev/ttyS0:999999999",
                           "replay",
                           "replay:",
                           "replay::2",
                           "tcp:board",
                           ":"}) {
    const auto opened = link::open_transport(name);
    ASSERT_FALSE(opened) << name;
    EXPECT_EQ(opened.error().kind, ErrorKind::kInvalid) << name;
    EXPECT_EQ(opened.error().message.find("'" + std::string(name) + "' is not a transport: "), 0U);
    EXPECT_NE(opened.error().message.find("serial:PATH[:BAUD]"), std::string::npos);
  }
}

TEST(TransportName, MayEndInANumberIfSuchAFileExists) {
  const TestFolder folder;
  const std::string path = folder / "usb-0:1:1.0";
  std::ofstream(path) << "x";
  const auto serial = link::open_transport("serial:" + path);
  ASSERT_FALSE(serial);
  EXPECT_EQ(serial.error().message, path + " is not a serial line");
  const auto replay = link::open_transport("replay:" + path + ":0.5");
  ASSERT_FALSE(replay);
  EXPECT_EQ(replay.error().message.find(path + " is not a recording"), 0U)
      << replay.error().message;
}

}  // namespace
}  // namespace fpga_stereo::test
