// Scripted and periodic events of a virtual board.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_board/faulty_board.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {

struct Event {
  enum class Kind { kUnplug, kStall, kReset, kHalt, kEmpty, kFault, kQuit };
  Kind kind = Kind::kReset;
  int amount = 0;  // ms (unplug, stall), transfers (empty) or number of faults
  sim::LineFault fault = sim::LineFault::kFlip;
  bool to_board = false;  // the direction of the fault
};

/// Describes the lines of a script, for --help.
extern const char* const kScriptHelp;

struct ScriptLine {
  std::optional<double> at;  // s since the start; nullopt: now
  Event event;
};
/// Parses a line such as "at 2.5 unplug 300" or "flip 10 to-board". Returns nullopt for empty lines
/// and comments (#). Throws UsageError, which quotes the line.
std::optional<ScriptLine> parse_script_line(const std::string& text);

class Events {
 public:
  /// Adds the events of a file, or with "-" those of standard input as its lines arrive.
  void add_script(const std::string& path);
  void add(double at, const Event& event);
  /// Adds an event every `period` s, first after one period.
  void add_periodic(double period, const Event& event);

  /// Executes the events due at `now`, s since the start. Returns false after the event quit.
  bool run(double now, sim::FaultyBoard& board, Line& line);
  /// Returns the time of the next event, s since the start; infinite if none is scheduled.
  double next_time() const;
  /// Returns how often the board was unplugged.
  std::uint64_t num_unplugged() const { return num_unplugged_; }

 private:
  struct Due {
    double at, period;  // s; period 0: once
    Event event;
  };
  void read_input(double now);
  bool execute(const Event& event, double now, sim::FaultyBoard& board, Line& line);

  std::vector<Due> due_;
  bool reads_stdin_ = false;
  std::string partial_line_;  // of standard input
  double plug_at_ = std::numeric_limits<double>::infinity();
  std::uint64_t num_unplugged_ = 0;
};

}  // namespace fpga_stereo::tools
