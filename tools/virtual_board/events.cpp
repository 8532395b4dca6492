#include "virtual_board/events.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>

#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

using Kind = Event::Kind;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kMaxMs = 3600000;

double parse_number(const std::string& text, const std::string& what, double max,
                    const std::string& line) {
  std::istringstream in(text);
  double value = 0;
  if (!(in >> value) || !in.eof() || !(value >= 0) || value > max) {
    throw UsageError(
        fmt::format("script line \"{}\": {} = \"{}\": allowed 0 to {:g}", line, what, text, max));
  }
  return value;
}

}  // namespace

const char* const kScriptHelp =
    "Script: lines of [at SECONDS] EVENT. Without a time, the event happens at the start or, on\n"
    "standard input, when its line arrives. # begins a comment. Events:\n"
    "  unplug MS         unplug the cable for MS milliseconds\n"
    "  stall MS          carry no bytes for MS milliseconds\n"
    "  reset             reset the board in mid-frame\n"
    "  flip N [to-board] inject N faults among the next bytes to the host, or to the board; other\n"
    "                    faults: drop, insert, double, lose, repeat, swap, truncate, garbage\n"
    "  halt              USB: halt the endpoint until the host clears it\n"
    "  empty N           USB: end N transfers without a byte\n"
    "  quit              end the program\n";

std::optional<ScriptLine> parse_script_line(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word && word[0] != '#';) words.push_back(word);
  if (words.empty()) return std::nullopt;
  ScriptLine line;
  if (words[0] == "at") {
    const std::string time = words.size() > 1 ? words[1] : "";
    line.at = parse_number(time, "at", 1e6, text);
    words.erase(words.begin(), words.begin() + 2);
  }
  const std::string name = words.empty() ? "" : words[0];
  std::size_t num_used = 1;
  const auto amount = [&](double max) {
    const std::string given = words.size() > 1 ? words[1] : "";
    num_used = 2;
    return static_cast<int>(parse_number(given, name, max, text));
  };
  Event& event = line.event;
  if (name == "quit" || name == "reset" || name == "halt") {
    event.kind = name == "quit" ? Kind::kQuit : name == "halt" ? Kind::kHalt : Kind::kReset;
  } else if (name == "unplug" || name == "stall") {
    event.kind = name == "stall" ? Kind::kStall : Kind::kUnplug;
    event.amount = amount(kMaxMs);
  } else if (name == "empty") {
    event.kind = Kind::kEmpty;
    event.amount = amount(1e6);
  } else if (const auto fault = sim::find_line_fault(name)) {
    event.kind = Kind::kFault;
    event.fault = *fault;
    event.amount = amount(1e6);
    event.to_board = words.size() > 2 && words[2] == "to-board";
    num_used += event.to_board ? 1 : 0;
  } else {
    throw UsageError(fmt::format(
        "script line \"{}\": \"{}\" is not an event: allowed are unplug, stall, reset, halt, "
        "empty, quit, flip, drop, insert, double, lose, repeat, swap, truncate, garbage",
        text, name));
  }
  if (words.size() > num_used) {
    throw UsageError(fmt::format("script line \"{}\": unexpected \"{}\"", text, words[num_used]));
  }
  return line;
}

void Events::add(double at, const Event& event) { due_.push_back({at, 0, event}); }

void Events::add_periodic(double period, const Event& event) {
  due_.push_back({period, period, event});
}

void Events::add_script(const std::string& path) {
  if (path == "-") {
    reads_stdin_ = true;
    return;
  }
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  for (std::string text; std::getline(file, text);) {
    if (const auto line = parse_script_line(text)) add(line->at.value_or(0), line->event);
  }
}

double Events::next_time() const {
  double next = plug_at_;
  for (const Due& due : due_) next = std::min(next, due.at);
  return next;
}

/// Adds the events of the lines that have arrived. Reports invalid lines on stderr.
void Events::read_input(double now) {
  pollfd in{STDIN_FILENO, POLLIN, 0};
  while (reads_stdin_ && poll(&in, 1, 0) > 0) {
    std::array<char, 4096> bytes{};
    const ssize_t got = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got <= 0) {
      reads_stdin_ = false;
      break;
    }
    partial_line_.append(bytes.data(), static_cast<std::size_t>(got));
  }
  for (std::size_t end; (end = partial_line_.find('\n')) != std::string::npos;) {
    try {
      if (const auto line = parse_script_line(partial_line_.substr(0, end))) {
        add(line->at.value_or(now), line->event);
      }
    } catch (const UsageError& e) {
      std::cerr << "virtual_board: " << e.what() << "\n";
    }
    partial_line_.erase(0, end + 1);
  }
}

bool Events::run(double now, sim::FaultyBoard& board, Line& line) {
  if (reads_stdin_) read_input(now);
  if (now >= plug_at_) {
    plug_at_ = kNever;
    line.plug(true);
  }
  bool is_running = true;
  std::vector<Due> later;
  for (Due due : std::exchange(due_, {})) {
    if (due.at > now) {
      later.push_back(due);
      continue;
    }
    is_running = execute(due.event, now, board, line) && is_running;
    if (due.period <= 0) continue;
    due.at += due.period * std::max(1.0, std::ceil((now - due.at) / due.period));
    later.push_back(due);
  }
  due_ = std::move(later);
  return is_running;
}

bool Events::execute(const Event& event, double now, sim::FaultyBoard& board, Line& line) {
  switch (event.kind) {
    case Kind::kUnplug:
      line.plug(false);
      plug_at_ = now + event.amount * 1e-3;
      ++num_unplugged_;
      break;
    case Kind::kStall:
      board.stall(std::chrono::milliseconds(event.amount));
      break;
    case Kind::kReset:
      board.reset_soon();
      break;
    case Kind::kHalt:
      line.halt();
      break;
    case Kind::kEmpty:
      line.send_empty(event.amount);
      break;
    case Kind::kFault:
      board.inject(!event.to_board, event.fault, event.amount);
      break;
    case Kind::kQuit:
      return false;
  }
  return true;
}

}  // namespace fpga_stereo::tools
