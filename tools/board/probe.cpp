// board probe.
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

/// Milliseconds of round trips, sorted.
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
  if (identity.supports(link::Stream::kInput)) text += "; takes pairs from the host";
  return text;
}

}  // namespace

void probe(const std::string& device, const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board probe [DEVICE] [options]\n"
      "Who answers: what it was built for, what it can send, how fast the line answers. The exit\n"
      "code is 1, and the message says what to do, where this software does not work with it.\n";
  add_patience(line.options);
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  Connection board(device, patience(parsed->options));
  const link::Identity identity = board.identify();
  const auto times = round_trips(board);
  const GatewareBuild& build = identity.build;
  print("line", board.snapshot().description);
  print("gateware",
        concat(identity.major, ".", identity.minor, ", specification ", hex(identity.spec_hash)));
  print("max_width", concat(build.max_width, " px"));
  print("disparities", std::to_string(build.disparities));
  print("census", concat(to_text(build.census_pattern), " ", build.census_window, " px"));
  print("correlation", concat(build.correlation_window, " px"));
  print("line buffer", concat(build.line_rows, " rows"));
  print("mesh", concat(build.mesh_nodes, " nodes"));
  print("clock", concat(identity.clock_hz / 1e6, " MHz"));
  print("streams", streams_text(identity));
  const std::uint32_t number = board.read({spec::kRegConfiguration})[0];
  print("configured", number == 0 ? "not yet: board upload, or the node, does"
                                  : concat(number, " times since it was powered"));
  std::ostringstream text;
  text << std::fixed << std::setprecision(2) << times.front() << " ms at best, median "
       << times[times.size() / 2] << " ms";
  print("round trip", text.str());
}

}  // namespace fpga_stereo::tools
