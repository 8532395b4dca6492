#include "virtual_board/events.hpp"

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

using What = Event::What;

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kLongestMs = 3600000;

double parse_number(const std::string& text, const std::string& what, double max,
                    const std::string& line) {
  std::istringstream in(text);
  double value = 0;
  if (!(in >> value) || !in.eof() || !(value >= 0) || value > max) {
    throw UsageError(
        concat("script line \"", line, "\": ", what, " = \"", text, "\": allowed 0 to ", max));
  }
  return value;
}

}  // namespace

const char* const kScriptHelp =
    "Script: lines of [at SECONDS] EVENT; without a time the event is at the start, or when its\n"
    "line comes on standard input. # begins a comment. Events:\n"
    "  unplug MS         the cable is pulled for so long\n"
    "  stall MS          nothing passes for so long\n"
    "  reset             the board is reset in mid-frame\n"
    "  flip N [to-board] so many of a fault among the next bytes to the host, or to the board:\n"
    "                    flip, drop, insert, double; lose, repeat, swap, truncate, garbage\n"
    "  halt              USB: the endpoint halts until the host clears it\n"
    "  empty N           USB: so many transfers without a byte\n"
    "  quit              the end\n";

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
  std::size_t taken = 1;
  const auto amount = [&](double max) {
    const std::string given = words.size() > 1 ? words[1] : "";
    taken = 2;
    return static_cast<int>(parse_number(given, name, max, text));
  };
  Event& event = line.event;
  if (name == "quit" || name == "reset" || name == "halt") {
    event.what = name == "quit" ? What::kQuit : name == "halt" ? What::kHalt : What::kReset;
  } else if (name == "unplug" || name == "stall") {
    event.what = name == "stall" ? What::kStall : What::kUnplug;
    event.amount = amount(kLongestMs);
  } else if (name == "empty") {
    event.what = What::kEmpty;
    event.amount = amount(1e6);
  } else if (const auto fault = sim::find_line_fault(name)) {
    event.what = What::kFault;
    event.fault = *fault;
    event.amount = amount(1e6);
    event.to_board = words.size() > 2 && words[2] == "to-board";
    taken += event.to_board ? 1 : 0;
  } else {
    throw UsageError(concat("script line \"", text, "\": \"", name,
                            "\" is no event: allowed unplug, stall, reset, halt, empty, quit, "
                            "flip, drop, insert, double, lose, repeat, swap, truncate, garbage"));
  }
  if (words.size() > taken) {
    throw UsageError(concat("script line \"", text, "\": \"", words[taken], "\" is too much"));
  }
  return line;
}

void Events::add(double at, const Event& event) { due_.push_back({at, 0, event}); }

void Events::add_periodic(double period, const Event& event) {
  due_.push_back({period, period, event});
}

void Events::add_script(const std::string& path) {
  if (path == "-") {
    input_ = true;
    return;
  }
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path + ": cannot be read: " + std::strerror(errno));
  for (std::string text; std::getline(file, text);) {
    if (const auto line = parse_script_line(text)) add(line->at.value_or(0), line->event);
  }
}

double Events::next() const {
  double next = plug_at_;
  for (const Due& due : due_) next = std::min(next, due.at);
  return next;
}

/// Lines that have come by now; a wrong one is named, and does nothing.
void Events::read_input(double now) {
  pollfd in{STDIN_FILENO, POLLIN, 0};
  while (input_ && poll(&in, 1, 0) > 0) {
    std::array<char, 4096> bytes{};
    const ssize_t got = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (got <= 0) {
      input_ = false;
      break;
    }
    partial_.append(bytes.data(), static_cast<std::size_t>(got));
  }
  for (std::size_t end; (end = partial_.find('\n')) != std::string::npos;) {
    try {
      if (const auto line = parse_script_line(partial_.substr(0, end))) {
        add(line->at.value_or(now), line->event);
      }
    } catch (const UsageError& e) {
      std::cerr << "virtual_board: " << e.what() << "\n";
    }
    partial_.erase(0, end + 1);
  }
}

bool Events::run(double now, sim::FaultyBoard& board, Line& line) {
  if (input_) read_input(now);
  if (now >= plug_at_) {
    plug_at_ = kNever;
    line.plug(true);
  }
  bool goes_on = true;
  std::vector<Due> later;
  for (Due due : std::exchange(due_, {})) {
    if (due.at > now) {
      later.push_back(due);
      continue;
    }
    goes_on = happen(due.event, now, board, line) && goes_on;
    if (due.period <= 0) continue;
    due.at += due.period * std::max(1.0, std::ceil((now - due.at) / due.period));
    later.push_back(due);
  }
  due_ = std::move(later);
  return goes_on;
}

bool Events::happen(const Event& event, double now, sim::FaultyBoard& board, Line& line) {
  switch (event.what) {
    case What::kUnplug:
      line.plug(false);
      plug_at_ = now + event.amount * 1e-3;
      ++unplugged_;
      break;
    case What::kStall:
      board.stall(std::chrono::milliseconds(event.amount));
      break;
    case What::kReset:
      board.reset_soon();
      break;
    case What::kHalt:
      line.halt();
      break;
    case What::kEmpty:
      line.send_empty(event.amount);
      break;
    case What::kFault:
      board.inject(!event.to_board, event.fault, event.amount);
      break;
    case What::kQuit:
      return false;
  }
  return true;
}

}  // namespace fpga_stereo::tools
