#include "virtual_board/engine.hpp"

#include "fpga_stereo/core/parameters.hpp"
#include "sim/virtual_board/gateware_board.hpp"
#include "sim/virtual_board/software_board.hpp"
#include "support/files.hpp"
#include "support/models.hpp"
#include "support/program.hpp"
#include "support/registers.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;
using Strings = std::vector<std::string>;

int int_option(const po::variables_map& options, const std::string& name, int min, int max) {
  const int value = options[name].as<int>();
  require_range("--" + name, value, min, max);
  return value;
}

/// Returns the build parameters. Throws UsageError if the pipeline or the registers do not support
/// them.
GatewareBuild build(const po::variables_map& options) {
  Parameters parameters = window_parameters();
  const auto set = [&](const std::string& option, const std::string& parameter) {
    const Status status = set_parameter(parameters, parameter, options[option].as<std::string>());
    if (!status) throw UsageError("--" + option + ": " + status.error().message);
  };
  set("disparities", "disparity_range");
  set("census", "census_window_size");
  set("pattern", "census_pattern");
  set("correlation", "correlation_window_size");
  GatewareBuild build;
  build.max_width = int_option(options, "max-width", kGatewareMinWidth, kGatewareMaxWidth);
  build.disparities = parameters.disparity_range;
  build.census_window = parameters.census_window_size;
  build.census_pattern = parameters.census_pattern;
  build.correlation_window = parameters.correlation_window_size;
  build.line_rows = int_option(options, "line-rows", 4, 254);
  build.mesh_nodes = int_option(options, "mesh-nodes", 1, 65535);
  if (!(GatewareBuild::from_registers(build.build_register(),
                                      static_cast<std::uint32_t>(build.line_rows),
                                      static_cast<std::uint32_t>(build.mesh_nodes)) == build)) {
    throw UsageError(
        "register BUILD cannot represent these build parameters: a window is too large for its "
        "field");
  }
  return build;
}

/// Parses REGISTER=VALUE of --wrong.
void add_wrong(const std::string& text, std::map<std::uint32_t, std::uint32_t>& wrong) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw UsageError("--wrong \"" + text + "\": allowed is REGISTER=VALUE");
  }
  const std::string name = text.substr(0, equals);
  const spec::Register& found = find_register(name);
  wrong[found.address] = parse_value(found.name, text.substr(equals + 1), ~std::uint32_t{0});
}

Engine make_software(const po::variables_map& options) {
  sim::SoftwareBoard::Options board_options;
  board_options.build = build(options);
  board_options.streams = link::StreamSet::from_bits(
      static_cast<std::uint32_t>(int_option(options, "streams", 0, 255)));
  board_options.max_queued_bytes =
      static_cast<std::size_t>(int_option(options, "waiting", 0, 1000000000));
  board_options.cached_pairs = static_cast<std::size_t>(int_option(options, "keep", 0, 1000000));
  board_options.num_threads = threads(options);
  board_options.packet_version =
      static_cast<std::uint8_t>(int_option(options, "packet-version", 0, 255));
  if (options["wrong-hash"].as<bool>()) board_options.overrides[spec::kRegSpecHash] = ~kSpecHash;
  if (options["wrong-identity"].as<bool>())
    board_options.overrides[spec::kRegIdentity] = 0x12345678;
  if (options["wrong-version"].as<bool>()) {
    const std::uint32_t next = spec::kVersionMajor.get(spec::kRegVersionReset) + 1;
    board_options.overrides[spec::kRegVersion] = spec::kVersionMajor.put(next);
  }
  if (options.count("wrong") != 0) {
    for (const std::string& text : options["wrong"].as<Strings>())
      add_wrong(text, board_options.overrides);
  }
  auto board = std::make_unique<sim::SoftwareBoard>(board_options);
  const sim::SoftwareBoard* raw = board.get();
  return {std::move(board), [raw](std::uint32_t address) { return raw->peek(address); }};
}

Engine make_gateware(const po::variables_map& options) {
  SystemBuild system_build;
  system_build.gateware = build(options);
  system_build.clock_hz = int_option(options, "clock-hz", 10000, 100000000);
  system_build.streams = int_option(options, "streams", 0, 255);
  const std::string folder =
      options.count("models") != 0 ? options["models"].as<std::string>() : default_models_folder();
  create_folder(folder);
  auto model = sim::SystemModel::open(require_system_model(system_build, folder, threads(options)));
  require(model);
  // Only a host can read the registers of the simulated gateware.
  return {std::make_unique<sim::GatewareBoard>(std::move(*model)), {}};
}

}  // namespace

po::options_description engine_options() {
  po::options_description options("Board");
  const sim::SoftwareBoard::Options defaults;
  const auto number = [&](const char* name, int value, const char* about) {
    options.add_options()(name, po::value<int>()->value_name("N")->default_value(value), about);
  };
  const auto text = [&](const char* name, const std::string& value, const char* about) {
    options.add_options()(name, po::value<std::string>()->value_name("N")->default_value(value),
                          about);
  };
  options.add_options()(
      "engine", po::value<std::string>()->value_name("NAME")->default_value("software"),
      "software: compute with the software pipeline; gateware: with the simulated gateware, which "
      "the first use builds (needs verilator; a minute or two)");
  number("max-width", defaults.build.max_width, "build: maximum image width, px [16 to 1280]");
  text("disparities", std::to_string(defaults.build.disparities), "build: disparity_range");
  text("census", std::to_string(defaults.build.census_window), "build: census_window_size");
  text("pattern", to_text(defaults.build.census_pattern), "build: census_pattern");
  text("correlation", std::to_string(defaults.build.correlation_window),
       "build: correlation_window_size");
  number("line-rows", defaults.build.line_rows, "build: rows of the line buffers [4 to 254]");
  number("mesh-nodes", defaults.build.mesh_nodes, "build: nodes per mesh [1 to 65535]");
  number("streams", static_cast<int>(defaults.streams.bits()),
         "build: bit s is set if it has stream s [0 to 255]");
  number("keep", 0, "software: number of pairs whose results are cached [0 to 1000000]");
  number("waiting", static_cast<int>(defaults.max_queued_bytes),
         "software: capacity of the queue to the host, bytes; beyond it frames are dropped [0 to "
         "1000000000]");
  number("clock-hz", 50000,
         "gateware: clock frequency, Hz; a slower simulation lags behind [10000 to 100000000]");
  options.add_options()(
      "models", po::value<std::string>()->value_name("DIR"),
      "gateware: folder of built gateware [default $XDG_CACHE_HOME/fpga_stereo or "
      "~/.cache/fpga_stereo]");
  add_threads_option(options);
  options.add_options()("wrong", po::value<Strings>()->multitoken()->value_name("REGISTER=VALUE"),
                        "software: fixed values of registers, which writes do not change");
  options.add_options()("wrong-hash", po::bool_switch(), "software: report another specification");
  options.add_options()("wrong-identity", po::bool_switch(),
                        "software: report another kind of board");
  options.add_options()("wrong-version", po::bool_switch(),
                        "software: report the next major version");
  number("packet-version", kLinkVersion, "software: version of its packets [0 to 255]");
  return options;
}

Engine make_engine(const po::variables_map& options) {
  const auto name = options["engine"].as<std::string>();
  if (name == "gateware") return make_gateware(options);
  if (name != "software") {
    throw UsageError("--engine = \"" + name + "\": allowed are software and gateware");
  }
  return make_software(options);
}

}  // namespace fpga_stereo::tools
