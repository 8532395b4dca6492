// board list.
#include <unistd.h>

#include <cerrno>
#include <iostream>

#include "board/modes.hpp"
#include "core/printable.hpp"
#include "fpga_stereo/link/transport.hpp"
#include "link/serial.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr std::size_t kMaxNameBytes = 300;

/// Returns why this user cannot open a device, as far as that is known without opening it.
std::string problem(const link::FoundDevice& device) {
  const std::string serial = "serial:";
  if (device.name.compare(0, serial.size(), serial) == 0) {
    const std::string path = device.name.substr(serial.size());
    return access(path.c_str(), R_OK | W_OK) == 0 ? "" : link::serial_error(errno, path).message;
  }
  if (device.description.find("LIBUSB_ERROR_ACCESS") != std::string::npos) {
    return "this user may not open it: run 'rosrun fpga_stereo board udev | sudo tee "
           "/etc/udev/rules.d/70-fpga-stereo.rules' and 'sudo udevadm control --reload', then plug "
           "the board in again; the rule is for devices whose manufacturer is fpga_stereo, and "
           "says "
           "what to do for others";
  }
  return "";
}

}  // namespace

void list_boards(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board list\n"
      "Lists all USB devices and serial ports that may be a board: the name to pass to other "
      "modes, a\n"
      "description, and why this user cannot open it. Sends nothing to any device.\n";
  if (!parse(line, arguments)) return;
  const auto devices = link::list_devices();
  for (const link::FoundDevice& device : devices) {
    std::cout << printable(device.name, kMaxNameBytes) << "  " << device.description << "\n";
    if (const std::string why = problem(device); !why.empty()) std::cout << "  " << why << "\n";
  }
  if (devices.empty()) {
    throw std::runtime_error(
        "no FT232H (0403:6014) on USB and no serial ports found: is the board plugged in and "
        "powered? (Virtual boards on pseudo terminals are not listed: their names are "
        "serial:PATH)");
  }
}

}  // namespace fpga_stereo::tools
