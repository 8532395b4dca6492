// board: finds, identifies, configures, measures and tests boards.
#include <fmt/format.h>

#include <algorithm>
#include <iomanip>
#include <iostream>

#include "board/modes.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {
namespace {

struct Mode {
  const char* name;
  const char* about;
  void (*run)(const Arguments&);
};

constexpr Mode kModes[]{
    {"list", "list devices that may be a board", list_boards},
    {"probe", "identify the board and check that it is compatible", probe},
    {"get", "read registers by name", get_registers},
    {"set", "write registers by name and read them back", set_registers},
    {"upload", "send calibration and parameters to the board", upload},
    {"capture", "write frames to image files", capture},
    {"measure", "measure throughput, frame rates, losses and latency", measure},
    {"record", "record all bytes of the link; replay:FILE plays them", record},
    {"selftest", "compare the results of the board with the software", self_test},
    {"compare", "find the first stage of the board that differs from the software", compare},
    {"flash", "load a bitstream into the FPGA", flash},
    {"udev", "print or install the udev rule that gives users access", udev_rule},
};

std::string mode_names() {
  std::string names;
  for (const Mode& mode : kModes) names += (names.empty() ? "" : ", ") + std::string(mode.name);
  return names;
}

void print_help() {
  std::cout << "Usage: board MODE [DEVICE] ...\n       board --version\nModes, each with its own "
               "--help:\n";
  for (const Mode& mode : kModes) {
    std::cout << "  " << std::left << std::setw(9) << mode.name << " " << mode.about << "\n";
  }
  std::cout << "DEVICE is one of the following; the default is usb\n"
               "  usb                  the first USB board\n"
               "  usb:serial=NUMBER    the board with this serial number\n"
               "  usb:port=1-2.3       the board at this bus and port\n"
               "  usb:match=REGEX      the first board whose serial number or name matches\n"
               "  serial:PATH[:BAUD]   a serial port; the default is 1000000 baud\n"
               "  /dev/...             the same with the default\n"
               "  replay:FILE[:SPEED]  a recording, for capture and measure; SPEED 0 is without "
               "delays\n";
}

void board(const Arguments& arguments) {
  if (arguments.empty()) throw UsageError("a mode is missing: allowed " + mode_names());
  if (is_help(arguments[0])) return print_help();
  if (arguments[0] == "--version") return print_version();
  const auto* mode = std::find_if(std::begin(kModes), std::end(kModes),
                                  [&](const Mode& m) { return m.name == arguments[0]; });
  if (mode == std::end(kModes)) {
    throw UsageError(fmt::format("unknown mode \"{}\": allowed {}", arguments[0], mode_names()));
  }
  catch_interrupts();
  mode->run(Arguments(arguments.begin() + 1, arguments.end()));
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("board", argc, argv, fpga_stereo::tools::board);
}
