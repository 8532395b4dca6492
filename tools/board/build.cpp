#include "board/build.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

#include "fpga_stereo/core/spec.hpp"
#include "support/parameter_options.hpp"
#include "support/stereo_job.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

StereoRectification rectification_from(const po::variables_map& options, cv::Size size,
                                       int min_disparity) {
  if (options.count("left-info") != 0) {
    return read_rectification(options["left-info"].as<std::string>(),
                              options["right-info"].as<std::string>(), min_disparity);
  }
  StereoGeometry geometry;
  geometry.image_size =
      options.count("size") != 0 ? parse_size(options["size"].as<std::string>()) : size;
  return identity_rectification(geometry, min_disparity);
}

}  // namespace

void add_configuration_options(CommandLine& line) {
  const auto text = [&](const char* name, const char* value, const char* about) {
    line.options.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  text("left-info", "YAML", "camera_info file of the left camera");
  text("right-info", "YAML", "camera_info file of the right camera");
  text("size", "WxH", "size of images that are rectified already, px");
  line.options.add(parameter_options());
}

bool check_configuration_options(const po::variables_map& options) {
  const auto given = [&](const char* name) { return options.count(name) != 0; };
  parameters_from(options);
  if (given("size")) {
    if (given("left-info") || given("right-info")) {
      throw UsageError("--size is not allowed together with --left-info and --right-info");
    }
    parse_size(options["size"].as<std::string>());
    return true;
  }
  if (!given("left-info") && !given("right-info")) return false;
  for (const char* info : {"left-info", "right-info"}) {
    if (!given(info)) throw UsageError(fmt::format("--{} (or --size) is missing", info));
  }
  return true;
}

BoardConfiguration board_configuration(const po::variables_map& options, const GatewareBuild& build,
                                       cv::Size size) {
  BoardConfiguration all;
  all.parameters = parameters_from(options, parameters_of(build));
  all.rectification = rectification_from(options, size, all.parameters.min_disparity);
  auto gateware = make_gateware_configuration(build, all.parameters, all.rectification);
  require(gateware, "this board does not support these settings: ");
  all.gateware = std::move(*gateware);
  return all;
}

cv::Size parse_size(const std::string& text) {
  int width = 0, height = 0;
  char end = 0;
  const bool is_valid = std::sscanf(text.c_str(), "%4dx%4d%c", &width, &height, &end) == 2;
  if (is_valid && width >= kGatewareMinWidth && width <= kGatewareMaxWidth && height >= 1 &&
      height <= kGatewareMaxHeight) {
    return {width, height};
  }
  throw UsageError(fmt::format("--size = \"{}\": allowed WIDTHxHEIGHT, {}x1 to {}x{}", text,
                               kGatewareMinWidth, kGatewareMaxWidth, kGatewareMaxHeight));
}

void apply_configuration(Connection& board, const GatewareConfiguration& configuration,
                         std::uint64_t tag, link::StreamSet streams, bool host_input,
                         double seconds) {
  const std::uint64_t before = board.snapshot().session.configurations;
  link::DesiredState wanted;
  wanted.configuration = std::make_shared<const GatewareConfiguration>(configuration);
  wanted.tag = tag;
  wanted.streams = streams;
  wanted.host_input = host_input;
  board.set_desired_state(wanted);
  const auto state = streams.empty() ? link::LinkState::kReady : link::LinkState::kStreaming;
  const bool is_applied = board.wait_until(seconds, [&](const Connection::Snapshot& now) {
    return now.state == state && now.session.configurations > before;
  });
  if (is_applied) return;
  throw std::runtime_error(
      fmt::format("the board did not apply the configuration within {:g} s: {}", seconds,
                  board.snapshot().trouble_text));
}

}  // namespace fpga_stereo::tools
