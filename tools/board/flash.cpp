// board flash.
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "board/modes.hpp"
#include "support/child.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {

void flash(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board flash FILE [options]\n"
      "Loads a bitstream into the FPGA with openFPGALoader, over the board's programming port.\n";
  line.positional = {"FILE"};
  line.options.add_options()(
      "board",
      boost::program_options::value<std::string>()->value_name("NAME")->default_value("ulx3s"),
      "name of the board in openFPGALoader");
  line.options.add_options()(
      "permanent", boost::program_options::bool_switch(),
      "write to the flash memory, so that the bitstream survives a power cycle");
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  const std::string& file = parsed->positional[0];
  if (std::filesystem::is_directory(file)) {
    throw std::runtime_error(file + ": is a folder, not a bitstream");
  }
  if (!std::ifstream(file)) {
    throw std::runtime_error(file + ": cannot be read: " + std::strerror(errno));
  }
  Arguments command{"openFPGALoader", "--board", parsed->options["board"].as<std::string>()};
  if (parsed->options["permanent"].as<bool>()) command.emplace_back("--write-flash");
  // A file name that begins with a dash must not be taken as an option.
  command.push_back(file[0] == '-' ? "./" + file : file);
  Child child(command, {},
              "openFPGALoader is missing: install it with 'sudo apt install openfpgaloader'");
  const int code = child.wait();
  if (code != 0) {
    throw std::runtime_error(
        fmt::format("openFPGALoader ended with code {}: the board may not hold {}", code, file));
  }
}

}  // namespace fpga_stereo::tools
