// What happens to a virtual board, and when: from a script, or again and again.
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_board/faulty_board.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {

/// One thing that happens.
struct Event {
  enum class What { kUnplug, kStall, kReset, kHalt, kEmpty, kFault, kQuit };
  What what = What::kReset;
  int amount = 0;  // ms of unplug and stall, transfers of empty, number of faults
  sim::LineFault fault = sim::LineFault::kFlip;
  bool to_board = false;  // the fault hits what the host sends
};

/// What the lines of a script may be, for --help.
extern const char* const kScriptHelp;

/// "at 2.5 unplug 300", "flip 10 to-board": the event, and when (s since the start; none: now).
/// Nothing for an empty line and for one that begins with #. Throws UsageError, which has the line.
struct ScriptLine {
  std::optional<double> at;
  Event event;
};
std::optional<ScriptLine> parse_script_line(const std::string& text);

class Events {
 public:
  /// A file that is read now, or "-": lines of standard input, as they come.
  void add_script(const std::string& path);
  void add(double at, const Event& event);
  /// Each `period` s, the first time after one.
  void add_periodic(double period, const Event& event);

  /// Does what is due at `now`, s since the start. False: it was told to quit.
  bool run(double now, sim::FaultyBoard& board, Line& line);
  /// When something happens next, s; infinite: nothing will.
  double next() const;
  std::uint64_t unplugged() const { return unplugged_; }

 private:
  struct Due {
    double at, period;  // 0: once
    Event event;
  };
  void read_input(double now);
  bool happen(const Event& event, double now, sim::FaultyBoard& board, Line& line);

  std::vector<Due> due_;
  bool input_ = false;  // standard input is open
  std::string partial_;
  double plug_at_ = std::numeric_limits<double>::infinity();
  std::uint64_t unplugged_ = 0;
};

}  // namespace fpga_stereo::tools
