// board upload.
#include <fmt/format.h>

#include <iostream>

#include "board/build.hpp"
#include "board/connection.hpp"
#include "board/modes.hpp"

namespace fpga_stereo::tools {
namespace {

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: board upload [DEVICE] --left-info YAML --right-info YAML [options]\n"
      "       board upload [DEVICE] --size WIDTHxHEIGHT [options]\n"
      "Sends calibration and parameters to the board and reads them back. They stay until "
      "power-off or\n"
      "the next upload. Parameters that the gateware fixes (disparities, windows, pattern) default "
      "to\n"
      "those of its build. If the board does not support a value, nothing is changed.\n";
  add_patience(line);
  add_configuration_options(line);
  return line;
}

}  // namespace

void upload(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  if (!check_configuration_options(parsed->options)) {
    throw UsageError("--left-info (or --size) is missing");
  }
  Connection board(device_of(*parsed), patience(parsed->options));
  const link::Identity identity = board.identify();
  const auto [parameters, rectification, gateware] =
      board_configuration(parsed->options, identity.build);
  apply_configuration(board, gateware, 0, {}, false, kConfigurationTimeout);

  const cv::Size size = rectification.geometry.image_size;
  const std::uint32_t number = board.read({spec::kRegConfiguration})[0];
  std::cout << "configuration " << number << " was sent and read back: " << size.width << "x"
            << size.height << ", line buffer " << line_rows(rectification) << " of "
            << identity.build.line_rows << " rows, mesh " << Mesh::node_count(size).area() << " of "
            << identity.build.mesh_nodes << " nodes\n";
  for (const ParameterInfo& info : parameter_table()) {
    std::cout << "  " << info.name << " = " << to_text(parameters, info) << "\n";
  }
}

}  // namespace fpga_stereo::tools
