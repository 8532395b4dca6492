// board probe.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <iostream>

#include "board/connection.hpp"
#include "board/modes.hpp"
#include "board/streams.hpp"
#include "support/registers.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr int kRoundTrips = 20;

void print(const std::string& what, const std::string& value) {
  std::cout << std::left << std::setw(14) << what << value << "\n";
}

/// Measures round trips. Returns their times in ms, sorted.
std::vector<double> round_trips(Connection& board) {
  std::vector<double> times;
  for (int i = 0; i < kRoundTrips; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    board.read({spec::kRegStatus});
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    times.push_back(took.count());
  }
  std::sort(times.begin(), times.end());
  return times;
}

std::string streams_text(const link::Identity& identity) {
  std::string text;
  for (const StreamName& each : kStreamNames) {
    if (identity.supports(each.stream)) text += (text.empty() ? "" : ", ") + std::string(each.name);
  }
  if (identity.supports(link::Stream::kInput)) text += "; accepts pairs from the host";
  return text;
}

}  // namespace

void probe(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board probe [DEVICE] [options]\n"
      "Prints the build parameters, streams and round-trip time of the board. If the board is not\n"
      "compatible with this software, the exit code is 1 and the message says what to do.\n";
  add_patience(line);
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  Connection board(device_of(*parsed), patience(parsed->options));
  const link::Identity identity = board.identify();
  const auto times = round_trips(board);
  const GatewareBuild& build = identity.build;
  print("line", board.snapshot().description);
  print("gateware", fmt::format("{}.{}, specification {}", identity.major, identity.minor,
                                hex(identity.spec_hash)));
  print("max_width", fmt::format("{} px", build.max_width));
  print("disparities", std::to_string(build.disparities));
  print("census", fmt::format("{} {} px", to_text(build.census_pattern), build.census_window));
  print("correlation", fmt::format("{} px", build.correlation_window));
  print("line buffer", fmt::format("{} rows", build.line_rows));
  print("mesh", fmt::format("{} nodes", build.mesh_nodes));
  print("clock", fmt::format("{:g} MHz", identity.clock_hz / 1e6));
  print("streams", streams_text(identity));
  const std::uint32_t number = board.read({spec::kRegConfiguration})[0];
  print("configured", number == 0 ? "not yet: run board upload or start the node"
                                  : fmt::format("{} times since power-on", number));
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << times.front() << " ms at best, median "
       << times[times.size() / 2] << " ms";
  print("round trip", text.str());
}

}  // namespace fpga_stereo::tools
