// board: finds, identifies, configures, measures and tests boards.
#include <algorithm>
#include <iomanip>
#include <iostream>

#include "board/modes.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {
namespace {

struct Mode {
  const char* name;
  bool takes_device;
  const char* about;
  void (*run)(const std::string&, const Arguments&);
};

constexpr Mode kModes[]{
    {"list", false, "every line on which there may be a board", list_boards},
    {"probe", true, "who answers, and whether this software works with it", probe},
    {"get", true, "registers by name", get_registers},
    {"set", true, "registers by name; what was written is read back", set_registers},
    {"upload", true, "calibration and parameters onto the board", upload},
    {"capture", true, "frames to image files", capture},
    {"measure", true, "throughput, frames, losses, latency", measure},
    {"record", true, "all bytes of the line to a file; replay:FILE is a device", record},
    {"selftest", true, "pairs through the board, compared with the software", self_test},
    {"flash", false, "a bitstream into the FPGA", flash},
    {"udev", false, "the rule that opens boards to users", udev_rule},
};

std::string mode_names() {
  std::string names;
  for (const Mode& mode : kModes) names += (names.empty() ? "" : ", ") + std::string(mode.name);
  return names;
}

void print_help() {
  std::cout << "Usage: board MODE [DEVICE] ...\nModes, each with its own --help:\n";
  for (const Mode& mode : kModes) {
    std::cout << "  " << std::left << std::setw(9) << mode.name << " " << mode.about << "\n";
  }
  std::cout << "DEVICE, usb unless told, is one of\n"
               "  usb                  the first USB board\n"
               "  usb:serial=NUMBER    that with this serial number\n"
               "  usb:port=1-2.3       that at this bus and port\n"
               "  usb:match=REGEX      the first whose serial number or name has a match\n"
               "  serial:PATH[:BAUD]   a serial line, at 1000000 baud unless told\n"
               "  replay:FILE[:SPEED]  what record wrote, for capture and measure; SPEED 0: at "
               "once\n";
}

bool is_device(const std::string& text) {
  return text == "usb" || (text[0] != '-' && text.find(':') != std::string::npos);
}

void board(const Arguments& arguments) {
  if (arguments.empty()) throw UsageError("a mode is missing: allowed " + mode_names());
  if (arguments[0] == "--help") return print_help();
  const auto* mode = std::find_if(std::begin(kModes), std::end(kModes),
                                  [&](const Mode& m) { return m.name == arguments[0]; });
  if (mode == std::end(kModes)) {
    throw UsageError(concat("mode \"", arguments[0], "\": allowed ", mode_names()));
  }
  catch_interrupts();
  Arguments rest(arguments.begin() + 1, arguments.end());
  std::string device = "usb";
  if (mode->takes_device && !rest.empty() && !rest[0].empty() && is_device(rest[0])) {
    device = rest[0];
    rest.erase(rest.begin());
  }
  mode->run(device, rest);
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("board", argc, argv, fpga_stereo::tools::board);
}
