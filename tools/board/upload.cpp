// board upload.
#include <fmt/format.h>

#include <iostream>

#include "board/build.hpp"
#include "board/connection.hpp"
#include "board/modes.hpp"
#include "support/parameter_options.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

constexpr double kConfigurationTimeout = 30;  // s, for two meshes over a slow serial port

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
  const auto text = [&](const char* name, const char* value, const char* about) {
    line.options.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  text("left-info", "YAML", "camera_info file of the left camera");
  text("right-info", "YAML", "camera_info file of the right camera");
  text("size", "WxH", "size of images that are rectified already, px");
  add_patience(line.options);
  line.options.add(parameter_options());
  return line;
}

/// Checks the options before anything is sent. Throws UsageError.
void check_usage(const po::variables_map& options) {
  const auto given = [&](const char* name) { return options.count(name) != 0; };
  if (given("size")) {
    if (given("left-info") || given("right-info")) {
      throw UsageError("--size is not allowed together with --left-info and --right-info");
    }
    parse_size(options["size"].as<std::string>());
    return;
  }
  for (const char* info : {"left-info", "right-info"}) {
    if (!given(info)) throw UsageError(fmt::format("--{} (or --size) is missing", info));
  }
}

StereoRectification rectification_from(const po::variables_map& options, int min_disparity) {
  if (options.count("size") != 0) {
    StereoGeometry geometry;
    geometry.image_size = parse_size(options["size"].as<std::string>());
    return identity_rectification(geometry, min_disparity);
  }
  return read_rectification(options["left-info"].as<std::string>(),
                            options["right-info"].as<std::string>(), min_disparity);
}

}  // namespace

void upload(const std::string& device, const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  check_usage(parsed->options);
  parameters_from(parsed->options);

  Connection board(device, patience(parsed->options));
  const link::Identity identity = board.identify();
  const Parameters parameters = parameters_from(parsed->options, parameters_of(identity.build));
  const StereoRectification rectification =
      rectification_from(parsed->options, parameters.min_disparity);
  const auto configuration = make_gateware_configuration(identity.build, parameters, rectification);
  require(configuration, "this board does not support these settings: ");
  apply_configuration(board, *configuration, 0, {}, false, kConfigurationTimeout);

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
