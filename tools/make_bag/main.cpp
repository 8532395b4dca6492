// make_bag: converts between image files and bags, and calibrates stereo cameras.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <regex>

#include "make_bag/modes.hpp"

namespace fpga_stereo::tools {
namespace {

struct Mode {
  const char* name;
  const char* about;
  void (*run)(const Arguments&);
};

constexpr Mode kModes[]{
    {"create", "write image files and a calibration to a bag", create_bag},
    {"calibrate", "calibrate a stereo camera from chessboard pairs", calibrate},
    {"extract", "write images, calibration and disparities of a bag to files", extract_bag},
    {"frames", "print the tf frames of a calibrated pair, as a URDF", print_frames},
};

void print_help() {
  std::cout
      << "Usage: make_bag MODE ...\n       make_bag --version\nModes, each with its own --help:\n";
  for (const Mode& mode : kModes) std::cout << "  " << mode.name << ": " << mode.about << "\n";
}

void make_bag(const Arguments& arguments) {
  if (arguments.empty())
    throw UsageError("a mode is missing: allowed are create, calibrate, extract, frames");
  if (is_help(arguments[0])) return print_help();
  if (arguments[0] == "--version") return print_version();
  const auto mode = std::find_if(std::begin(kModes), std::end(kModes),
                                 [&](const Mode& m) { return m.name == arguments[0]; });
  if (mode == std::end(kModes)) {
    throw UsageError(fmt::format(
        "unknown mode \"{}\": allowed are create, calibrate, extract, frames", arguments[0]));
  }
  mode->run(Arguments(arguments.begin() + 1, arguments.end()));
}

}  // namespace

void add_camera_option(boost::program_options::options_description& options) {
  options.add_options()(
      "camera",
      boost::program_options::value<std::string>()->value_name("NAME")->default_value("stereo"),
      "namespace of the topics: /NAME/left/image_raw and so on");
}

std::string camera_name(const boost::program_options::variables_map& options) {
  static const std::regex allowed("/?([A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*)/?");
  const std::string given = options["camera"].as<std::string>();
  std::smatch match;
  if (std::regex_match(given, match, allowed)) return match[1];
  throw UsageError(fmt::format(
      "--camera \"{}\": allowed is a ROS name: a letter, then letters, digits, _ and /", given));
}

}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  return fpga_stereo::tools::run_program("make_bag", argc, argv, fpga_stereo::tools::make_bag);
}
