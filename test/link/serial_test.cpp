#include "link/serial.hpp"

#include <asm/termbits.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "link/test_folder.hpp"

namespace fpga_stereo::test {
namespace {

namespace fs = std::filesystem;

/// A pty; keeps the master open.
struct Pty {
  int master = posix_openpt(O_RDWR | O_NOCTTY), slave = -1;
  std::array<char, 64> path{};
  Pty() {
    EXPECT_EQ(grantpt(master) | unlockpt(master) | ptsname_r(master, path.data(), path.size()), 0);
    slave = open(path.data(), O_RDWR | O_NOCTTY);
  }
  ~Pty() {
    close(master);
    close(slave);
  }
};

termios2 settings_of(int file) {
  struct termios2 settings {};
  EXPECT_EQ(ioctl(file, TCGETS2, &settings), 0);
  return settings;
}

TEST(Serial, SetsAnyRate) {
  for (const int baud : {3000000, 12345, 12000000, 1}) {
    Pty pty;
    const auto opened = link::open_serial(pty.path.data(), baud);
    ASSERT_TRUE(opened) << opened.error().message;
    const auto settings = settings_of(pty.slave);
    EXPECT_EQ(settings.c_ospeed, static_cast<speed_t>(baud));
    EXPECT_EQ(settings.c_ispeed, static_cast<speed_t>(baud));
    EXPECT_EQ(settings.c_cflag & CSIZE, static_cast<tcflag_t>(CS8));
    EXPECT_EQ(settings.c_cflag & (PARENB | CSTOPB | CRTSCTS), 0U);
    EXPECT_EQ(settings.c_lflag | settings.c_oflag | settings.c_iflag, 0U);
    EXPECT_EQ((*opened)->description(),
              std::string(pty.path.data()) + " at " + std::to_string(baud) + " baud");
  }
}

TEST(Serial, AcceptsARateInItsName) {
  Pty pty;
  const auto opened = link::open_transport("serial:" + std::string(pty.path.data()) + ":921600");
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(settings_of(pty.slave).c_ospeed, 921600U);
  const auto second = link::open_transport("serial:" + std::string(pty.path.data()));
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::kBusy);
  EXPECT_NE(second.error().message.find(pty.path.data()), std::string::npos);
}

TEST(Serial, NamesTheReasonOfAFailure) {
  const struct {
    int code;
    ErrorKind kind;
    const char* says;
  } cases[] = {
      {ENOENT, ErrorKind::kNotFound, "/dev/null cannot be opened"},
      {EIO, ErrorKind::kNotFound, "found"},
      {EBUSY, ErrorKind::kBusy, "another program"},
      {EWOULDBLOCK, ErrorKind::kBusy, "another program"},
      {EACCES, ErrorKind::kPermission, "group root: run 'sudo usermod -aG root $USER'"},
      {EPERM, ErrorKind::kPermission, "group root"},
      {ENOTTY, ErrorKind::kIo, "not a serial line"},
      {EMFILE, ErrorKind::kIo, "Too many open files"},
  };
  for (const auto& expected : cases) {
    const Error error = link::serial_error(expected.code, "/dev/null");
    EXPECT_EQ(error.kind, expected.kind) << expected.code;
    EXPECT_NE(error.message.find(expected.says), std::string::npos) << error.message;
  }
  EXPECT_EQ(link::open_serial("/dev/no_such_line").error().kind, ErrorKind::kNotFound);
  EXPECT_EQ(link::open_serial("/dev/null").error().kind, ErrorKind::kIo);
}

TEST(Serial, PrefersStableNames) {
  const TestFolder folder;
  for (const char* file : {"ttyUSB1", "ttyACM0", "ttyS0", "null"}) std::ofstream(folder / file);
  auto found = link::list_serial(folder.path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "serial:" + folder / "ttyACM0");
  EXPECT_EQ(found[1].name, "serial:" + folder / "ttyUSB1");
  fs::create_directories(folder / "serial/by-id");
  fs::create_symlink("../../ttyUSB1", folder / "serial/by-id/usb-FTDI-if00");
  found = link::list_serial(folder.path());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].name, "serial:" + folder / "serial/by-id/usb-FTDI-if00");
  EXPECT_EQ(found[0].description, "serial line ttyUSB1");
  fs::create_symlink("gone", folder / "serial/by-id/usb-\x1b[2J");
  found = link::list_serial(folder.path());
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].description, "serial line usb-\\x1b[2J");
}

}  // namespace
}  // namespace fpga_stereo::test
