// board list.
#include <unistd.h>

#include <cerrno>
#include <iostream>

#include "board/modes.hpp"
#include "fpga_stereo/link/transport.hpp"
#include "link/serial.hpp"

namespace fpga_stereo::tools {
namespace {

/// What keeps the user from a line; empty: nothing that can be told without opening it.
std::string problem(const link::FoundDevice& device) {
  const std::string serial = "serial:";
  if (device.name.compare(0, serial.size(), serial) == 0) {
    const std::string path = device.name.substr(serial.size());
    return access(path.c_str(), R_OK | W_OK) == 0 ? "" : link::serial_error(errno, path).message;
  }
  if (device.description.find("LIBUSB_ERROR_ACCESS") != std::string::npos) {
    return "may not be opened by this user: 'rosrun fpga_stereo board udev | sudo tee "
           "/etc/udev/rules.d/70-fpga-stereo.rules', 'sudo udevadm control --reload', then plug "
           "the "
           "board in again";
  }
  return "";
}

}  // namespace

void list_boards(const std::string&, const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board list\n"
      "Every USB device and serial line on which there may be a board: its name, as other modes\n"
      "take it, what it is, and what keeps this user from it. Nothing is sent to any of them.\n";
  if (!parse(line, arguments)) return;
  const auto devices = link::list_devices();
  for (const link::FoundDevice& device : devices) {
    std::cout << device.name << "  " << device.description << "\n";
    if (const std::string why = problem(device); !why.empty()) std::cout << "  " << why << "\n";
  }
  if (devices.empty()) {
    throw std::runtime_error(
        "there is no FT232H (0403:6014) on USB and no serial line: is the board plugged in and "
        "powered? (A virtual board on a pseudo terminal is not listed: its name is serial:PATH)");
  }
}

}  // namespace fpga_stereo::tools
