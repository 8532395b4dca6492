// board upload.
#include <iostream>

#include "board/build.hpp"
#include "board/connection.hpp"
#include "board/modes.hpp"
#include "support/parameter_options.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

constexpr double kConfigureTime = 30;  // s: a slow line carries two meshes, and reads them back

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: board upload [DEVICE] --left-info YAML --right-info YAML [options]\n"
      "       board upload [DEVICE] --size WIDTHxHEIGHT [options]\n"
      "Calibration and parameters onto the board, read back; they stay until it loses power or\n"
      "somebody else uploads. Parameters that its gateware fixes (disparities, windows, pattern)\n"
      "are its own unless told; what it cannot do is refused, and nothing is changed.\n";
  const auto text = [&](const char* name, const char* value, const char* about) {
    line.options.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  text("left-info", "YAML", "camera_info of the left camera");
  text("right-info", "YAML", "camera_info of the right camera");
  text("size", "WxH", "of images that are rectified already, px");
  add_patience(line.options);
  line.options.add(parameter_options());
  return line;
}

/// Throws UsageError before anything is sent.
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
    if (!given(info)) throw UsageError(concat("--", info, " (or --size) is missing"));
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
  const auto made = make_gateware_configuration(identity.build, parameters, rectification);
  require(made, "this board cannot do that: ");
  configure(board, *made, 0, 0, false, kConfigureTime);

  const cv::Size size = rectification.geometry.image_size;
  const std::uint32_t number = board.read({spec::kRegConfiguration})[0];
  std::cout << "configuration " << number << " was written and read back: " << size.width << "x"
            << size.height << ", line buffer " << line_rows(rectification) << " of "
            << identity.build.line_rows << " rows, mesh " << Mesh::node_count(size).area() << " of "
            << identity.build.mesh_nodes << " nodes\n";
  for (const ParameterInfo& info : parameter_table()) {
    std::cout << "  " << info.name << " = " << to_text(parameters, info) << "\n";
  }
}

}  // namespace fpga_stereo::tools
