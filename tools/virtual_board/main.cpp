// virtual_board: a program that acts as a board, on a pseudo terminal, on virtual USB or as a USB
// gadget.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <sstream>

#include "fpga_stereo/core/spec.hpp"
#include "support/interrupt.hpp"
#include "support/program.hpp"
#include "virtual_board/cameras.hpp"
#include "virtual_board/engine.hpp"
#include "virtual_board/events.hpp"
#include "virtual_board/line.hpp"
#include "virtual_board/read_bag.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;
using Strings = std::vector<std::string>;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kMaxWait{10};

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: virtual_board --pty PATH [options]\n"
      "       virtual_board --usb[=SERIAL] [options] -- COMMAND [ARGUMENTS]\n"
      "       virtual_board --gadget[=SERIAL] [options]\n"
      "Acts as a board. With --pty it is a serial port: PATH is a symbolic link to a pseudo "
      "terminal,\n"
      "which any program opens as serial:PATH. With --usb it is a virtual FT232H: COMMAND and its\n"
      "children see it instead of the USB devices of this machine; the exit code is that of "
      "COMMAND.\n"
      "With --gadget it is an FT232H for the host at a USB device controller of this machine; "
      "that\n"
      "needs root and the kernel's module usb_f_fs.\n"
      "Ends on Ctrl-C and prints statistics to stderr.\n";
  const auto text = [&](const char* name, const char* value, const char* about) {
    line.options.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  const auto number = [](po::options_description& options, const char* name, const char* value,
                         const char* about) {
    options.add_options()(name, po::value<double>()->value_name(value)->default_value(0), about);
  };
  text("pty", "PATH", "be a serial port; prints \"ready PATH\" when the port exists");
  line.options.add_options()(
      "usb", po::value<std::string>()->value_name("SERIAL")->implicit_value("FS000001"),
      "be a USB device with this serial number");
  line.options.add_options()(
      "gadget", po::value<std::string>()->value_name("SERIAL")->implicit_value("FS000001"),
      "be a USB gadget with this serial number; prints \"ready CONTROLLER\" when it is plugged in");

  po::options_description cameras("Cameras (default: none; the host sends the pairs)");
  cameras.add_options()("images", po::value<Strings>()->multitoken()->value_name("LEFT RIGHT"),
                        "one pair of image files");
  const auto camera_text = [&](const char* name, const char* value, const char* about) {
    cameras.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  camera_text("folder", "DIR", "repeat the pairs of DIR/left and DIR/right, sorted by name");
  camera_text("bag", "FILE", "repeat the pairs of a bag");
  cameras.add_options()("camera",
                        po::value<std::string>()->value_name("NAME")->default_value("stereo"),
                        "for --bag: the topics are /NAME/left/image_raw and /NAME/right/image_raw");
  cameras.add_options()("first", po::value<int>()->value_name("N")->default_value(200),
                        "use only the first N pairs; all are held in memory [1 to 1000000]");
  number(cameras, "rate", "HZ", "pairs per second [0 to 10000]; 0: no pairs");
  line.options.add(cameras);
  line.options.add(engine_options());

  po::options_description faults("Faults of the line (mean number per MiB to the host)");
  for (int i = 0; i < sim::kNumLineFaults; ++i) {
    static const char* const kAbout[] = {"bits inverted",
                                         "bytes lost",
                                         "bytes inserted",
                                         "bytes duplicated",
                                         "packets lost",
                                         "packets duplicated",
                                         "packets swapped with the next one",
                                         "packets truncated",
                                         "runs of random bytes before a packet"};
    number(faults, sim::name(static_cast<sim::LineFault>(i)), "RATE", kAbout[i]);
  }
  faults.add_options()("both-ways", po::bool_switch(),
                       "apply the same rates to bytes from the host");
  faults.add_options()("seed", po::value<std::uint64_t>()->value_name("N")->default_value(1),
                       "seed of all random faults");
  line.options.add(faults);

  po::options_description events("Timed faults");
  const auto event_text = [&](const char* name, const char* value, const char* about) {
    events.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  event_text("unplug", "S:MS", "every S seconds, unplug the cable for MS milliseconds");
  event_text("stall", "S:MS", "every S seconds, carry no bytes for MS milliseconds");
  event_text("reset", "S", "every S seconds, reset the board in mid-frame");
  event_text("halt", "S", "USB: every S seconds, halt the endpoint");
  event_text("empty", "S:N", "USB: every S seconds, end N transfers without a byte");
  events.add_options()("short", po::value<int>()->value_name("BYTES")->default_value(0),
                       "USB: limit packets to this many bytes [0 to 510]; 0: no limit");
  number(events, "slow", "BYTES", "limit the rate to the host, bytes/s; 0: no limit");
  event_text("script", "FILE", "execute the events of a file; -: of standard input");
  line.options.add(events);
  line.notes = std::string("\n") + kScriptHelp;
  return line;
}

std::vector<sim::GreyPair> read_cameras(const po::variables_map& options) {
  const bool images = options.count("images") != 0;
  const bool folder = options.count("folder") != 0;
  const bool bag = options.count("bag") != 0;
  if (images + folder + bag > 1) {
    throw UsageError("--images, --folder and --bag exclude each other: give at most one");
  }
  const double rate = options["rate"].as<double>();
  require_range("--rate", rate, 0, 10000);
  const int first = options["first"].as<int>();
  require_range("--first", first, 1, 1000000);
  const auto max_pairs = static_cast<std::size_t>(first);
  if (rate > 0 && images + folder + bag == 0) {
    throw UsageError("--rate needs --images, --folder or --bag");
  }
  if (folder) return read_folder(options["folder"].as<std::string>(), max_pairs);
  if (bag) {
    return read_bag(options["bag"].as<std::string>(), options["camera"].as<std::string>(),
                    max_pairs);
  }
  if (!images) return {};
  const Strings paths = options["images"].as<Strings>();
  if (paths.size() != 2) {
    throw UsageError(fmt::format("--images has {} files: allowed 2, LEFT and RIGHT", paths.size()));
  }
  return read_image_pair(paths[0], paths[1]);
}

sim::FaultyBoard::Options line_faults(const po::variables_map& options) {
  sim::FaultyBoard::Options faults;
  for (int i = 0; i < sim::kNumLineFaults; ++i) {
    const std::string name = sim::name(static_cast<sim::LineFault>(i));
    const double rate = options[name].as<double>();
    require_range("--" + name, rate, 0, 1 << 20);
    faults.to_host[static_cast<std::size_t>(i)] = rate;
  }
  if (options["both-ways"].as<bool>()) faults.from_host = faults.to_host;
  faults.seed = options["seed"].as<std::uint64_t>();
  faults.bytes_per_s = options["slow"].as<double>();
  require_range("--slow", faults.bytes_per_s, 0, 1e12);
  return faults;
}

void add_periodic(const po::variables_map& options, Events& events) {
  for (const std::string name : {"unplug", "stall", "reset", "halt", "empty"}) {
    if (options.count(name) == 0) continue;
    const std::string given = options[name].as<std::string>();
    const std::size_t colon = given.find(':');
    std::string text = fmt::format("at {} {}", given.substr(0, colon), name);
    if (colon != std::string::npos) text += " " + given.substr(colon + 1);
    const auto parsed = parse_script_line(text);
    if (*parsed->at <= 0)
      throw UsageError(fmt::format("--{} = \"{}\": allowed are periods above 0 s", name, given));
    events.add_periodic(*parsed->at, parsed->event);
  }
  if (options.count("script") != 0) events.add_script(options["script"].as<std::string>());
}

std::unique_ptr<Line> make_line(const po::variables_map& options, sim::FaultyBoard& board,
                                const Strings& command) {
  const bool pty = options.count("pty") != 0, usb = options.count("usb") != 0;
  const bool gadget = options.count("gadget") != 0;
  if (pty + usb + gadget != 1) throw UsageError("give exactly one of --pty, --usb and --gadget");
  if (usb == command.empty()) {
    throw UsageError(usb ? "-- COMMAND is missing: --usb starts the program that uses the board"
                         : "-- COMMAND is allowed for --usb only");
  }
  for (const char* other : {"halt", "empty"}) {
    if (pty && options.count(other) != 0) {
      throw UsageError(fmt::format("--{} needs --usb or --gadget", other));
    }
  }
  const int max_payload = options["short"].as<int>();
  require_range("--short", max_payload, 0, 510);
  if (pty) {
    if (max_payload != 0) throw UsageError("--short needs --usb or --gadget");
    return make_pty_line(board, options["pty"].as<std::string>());
  }
  auto line = usb ? make_usb_line(board, options["usb"].as<std::string>(), command)
                  : make_gadget_line(board, options["gadget"].as<std::string>());
  line->limit_packets(max_payload);
  return line;
}

/// A board with its cameras, events and line.
class VirtualBoard {
 public:
  VirtualBoard(const po::variables_map& options, const Strings& command)
      : pairs_(read_cameras(options)),
        rate_(options["rate"].as<double>()),
        engine_(make_engine(options)),
        board_(std::move(engine_.board), line_faults(options)) {
    add_periodic(options, events_);
    line_ = make_line(options, board_, command);
  }

  /// Runs until the host program ends, the script quits or an interrupt. Returns the exit code.
  int run() {
    if (!line_->path().empty()) std::cout << "ready " << line_->path() << std::endl;
    const auto start = Clock::now();
    auto last = start;
    std::optional<int> code;
    while (!code && !interrupted()) {
      const auto now = Clock::now();
      const auto passed = std::chrono::duration_cast<std::chrono::microseconds>(now - last);
      last += passed;
      board_.run(passed);
      const double seconds = std::chrono::duration<double>(now - start).count();
      if (!events_.run(seconds, board_, *line_)) break;
      feed(seconds);
      line_->serve(wait(start));
      code = line_->exit_code();
    }
    if (!code && interrupted()) code = line_->exit_code();
    return code.value_or(kSuccess);
  }

  std::string statistics() const;

 private:
  void feed(double now) {
    if (rate_ <= 0 || now < next_frame_) return;
    board_.feed(pairs_[num_fed_++ % pairs_.size()]);
    next_frame_ += 1 / rate_;
    // Cameras do not wait for a slow board: skip the frames that are late.
    if (next_frame_ >= now) return;
    const double missed = std::ceil((now - next_frame_) * rate_);
    num_late_ += static_cast<std::uint64_t>(missed);
    next_frame_ += missed / rate_;
  }
  /// Returns the time until the next event or frame.
  milliseconds wait(Clock::time_point start) const {
    const double now = std::chrono::duration<double>(Clock::now() - start).count();
    const double due = std::min(events_.next_time(), rate_ > 0 ? next_frame_ : now + 1);
    const double ms = std::clamp((due - now) * 1e3, 0.0, static_cast<double>(kMaxWait.count()));
    return milliseconds(static_cast<int>(std::ceil(ms)));
  }

  const std::vector<sim::GreyPair> pairs_;
  const double rate_;
  Engine engine_;
  sim::FaultyBoard board_;
  Events events_;
  std::unique_ptr<Line> line_;  // uses board_
  double next_frame_ = 0;       // s since the start
  std::uint64_t num_fed_ = 0, num_late_ = 0;
};

std::string VirtualBoard::statistics() const {
  const sim::FaultyBoard::Counts counts = board_.counts();
  std::ostringstream text;
  text << "virtual_board: " << num_fed_ << " pairs from the cameras, " << num_late_
       << " skipped because the engine was too slow\n";
  if (engine_.peek) {
    text << "virtual_board: " << engine_.peek(spec::kRegFramesDropped)
         << " frames dropped since the last reset because the queue to the host was full\n";
  }
  text << "virtual_board: " << counts.to_host << " bytes to the host, " << counts.from_host
       << " bytes from the host, " << counts.lost << " bytes lost because no host was connected\n"
       << "virtual_board: " << counts.resets << " resets, " << events_.num_unplugged()
       << " times unplugged, " << counts.stalls << " stalls\n";
  for (const bool to_host : {true, false}) {
    const auto& done = to_host ? counts.faults_to_host : counts.faults_from_host;
    text << "virtual_board: faults to the " << (to_host ? "host:" : "board:");
    for (int i = 0; i < sim::kNumLineFaults; ++i) {
      text << " " << sim::name(static_cast<sim::LineFault>(i)) << " "
           << done[static_cast<std::size_t>(i)];
    }
    text << "\n";
  }
  return text.str();
}

int virtual_board(Arguments arguments) {
  const auto dashes = std::find(arguments.begin(), arguments.end(), "--");
  Strings command;
  if (dashes != arguments.end()) command.assign(dashes + 1, arguments.end());
  arguments.erase(dashes, arguments.end());
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return kSuccess;
  catch_interrupts();
  VirtualBoard board(parsed->options, command);
  const int code = board.run();
  std::cerr << board.statistics();
  return code;
}

}  // namespace
}  // namespace fpga_stereo::tools

int main(int argc, char** argv) {
  int code = 0;
  const int failed = fpga_stereo::tools::run_program(
      "virtual_board", argc, argv, [&](const fpga_stereo::tools::Arguments& arguments) {
        code = fpga_stereo::tools::virtual_board(arguments);
      });
  return failed != 0 ? failed : code;
}
