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

int whole(const po::variables_map& options, const std::string& name, int min, int max) {
  const int value = options[name].as<int>();
  require_range("--" + name, value, min, max);
  return value;
}

/// Whatever the pipeline can be set to, a board can be built for.
GatewareBuild build(const po::variables_map& options) {
  Parameters parameters;
  const auto set = [&](const std::string& option, const std::string& parameter) {
    const Status status = set_parameter(parameters, parameter, options[option].as<std::string>());
    if (!status) throw UsageError("--" + option + ": " + status.error().message);
  };
  set("disparities", "disparity_range");
  set("census", "census_window_size");
  set("pattern", "census_pattern");
  set("correlation", "correlation_window_size");
  GatewareBuild build;
  build.max_width = whole(options, "max-width", kGatewareMinWidth, kGatewareMaxWidth);
  build.disparities = parameters.disparity_range;
  build.census_window = parameters.census_window_size;
  build.census_pattern = parameters.census_pattern;
  build.correlation_window = parameters.correlation_window_size;
  build.line_rows = whole(options, "line-rows", 4, 254);
  build.mesh_nodes = whole(options, "mesh-nodes", 1, 65535);
  if (!(GatewareBuild::from_registers(build.build_register(),
                                      static_cast<std::uint32_t>(build.line_rows),
                                      static_cast<std::uint32_t>(build.mesh_nodes)) == build)) {
    throw UsageError(
        "a board cannot say that it has these build parameters: a window is too "
        "large for its field of register BUILD");
  }
  return build;
}

/// NAME=VALUE of --wrong.
void add_wrong(const std::string& text, std::map<std::uint32_t, std::uint32_t>& wrong) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) {
    throw UsageError("--wrong \"" + text + "\": allowed REGISTER=VALUE");
  }
  const spec::Register& found = find_register(text.substr(0, equals));
  wrong[found.address] = parse_value(found.name, text.substr(equals + 1), ~std::uint32_t{0});
}

Engine make_software(const po::variables_map& options) {
  sim::SoftwareBoard::Options made;
  made.build = build(options);
  made.streams =
      link::StreamSet::from_bits(static_cast<std::uint32_t>(whole(options, "streams", 0, 255)));
  made.max_queued_bytes = static_cast<std::size_t>(whole(options, "waiting", 0, 1000000000));
  made.cached_pairs = static_cast<std::size_t>(whole(options, "keep", 0, 1000000));
  made.num_threads = threads(options);
  made.packet_version = static_cast<std::uint8_t>(whole(options, "packet-version", 0, 255));
  if (options["wrong-hash"].as<bool>()) made.overrides[spec::kRegSpecHash] = ~kSpecHash;
  if (options["wrong-identity"].as<bool>()) made.overrides[spec::kRegIdentity] = 0x12345678;
  if (options["wrong-version"].as<bool>()) {
    const std::uint32_t next = spec::kVersionMajor.get(spec::kRegVersionReset) + 1;
    made.overrides[spec::kRegVersion] = spec::kVersionMajor.put(next);
  }
  if (options.count("wrong") != 0) {
    for (const std::string& text : options["wrong"].as<Strings>()) add_wrong(text, made.overrides);
  }
  auto board = std::make_unique<sim::SoftwareBoard>(made);
  const sim::SoftwareBoard* raw = board.get();
  return {std::move(board), [raw](std::uint32_t address) { return raw->peek(address); }};
}

Engine make_gateware(const po::variables_map& options) {
  SystemBuild wanted;
  wanted.gateware = build(options);
  wanted.clock_hz = whole(options, "clock-hz", 10000, 100000000);
  wanted.streams = whole(options, "streams", 0, 255);
  const std::string folder =
      options.count("models") != 0 ? options["models"].as<std::string>() : default_models_folder();
  create_folder(folder);
  auto model = sim::SystemModel::open(system_model(wanted, folder, threads(options)));
  require(model);
  // What its registers hold only its host can ask.
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
      "what computes: software, the pipeline in software; gateware, the simulated one with its "
      "link, built at its first use (needs verilator; a minute or two)");
  number("max-width", defaults.build.max_width, "built for: widest image, px [16 to 1280]");
  text("disparities", std::to_string(defaults.build.disparities), "built for: disparity_range");
  text("census", std::to_string(defaults.build.census_window), "built for: census_window_size");
  text("pattern", to_text(defaults.build.census_pattern), "built for: census_pattern");
  text("correlation", std::to_string(defaults.build.correlation_window),
       "built for: correlation_window_size");
  number("line-rows", defaults.build.line_rows, "rows of its line buffers [4 to 254]");
  number("mesh-nodes", defaults.build.mesh_nodes, "nodes that a mesh may have [1 to 65535]");
  number("streams", static_cast<int>(defaults.streams.bits()), "bit s: it has stream s [0 to 255]");
  number("keep", 0, "results of so many pairs are kept: when they come again, they cost nothing");
  number("waiting", static_cast<int>(defaults.max_queued_bytes),
         "bytes that may wait for the host; frames behind them are dropped [0 to 1000000000]");
  number("clock-hz", 50000,
         "gateware: its clock; a simulation that is slower lags behind [10000 to 100000000]");
  options.add_options()("models", po::value<std::string>()->value_name("DIR"),
                        "gateware: folder of what was built [default ~/.cache/fpga_stereo, or in "
                        "XDG_CACHE_HOME]");
  add_threads_option(options);
  options.add_options()("wrong", po::value<Strings>()->multitoken()->value_name("REGISTER=VALUE"),
                        "what registers hold, whatever is written: defects, wrong identity");
  options.add_options()("wrong-hash", po::bool_switch(), "gateware of another specification");
  options.add_options()("wrong-identity", po::bool_switch(), "no board of this kind");
  options.add_options()("wrong-version", po::bool_switch(), "gateware of the next major version");
  number("packet-version", kLinkVersion, "version of the packets that it speaks [0 to 255]");
  return options;
}

Engine make_engine(const po::variables_map& options) {
  const auto name = options["engine"].as<std::string>();
  if (name == "gateware") return make_gateware(options);
  if (name != "software") {
    throw UsageError("--engine = \"" + name + "\": allowed software or gateware");
  }
  return make_software(options);
}

}  // namespace fpga_stereo::tools
