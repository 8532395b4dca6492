// virtual_board: a board that is a program, reached over a pseudo terminal or emulated USB.
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

constexpr milliseconds kLongestWait{10};

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: virtual_board --pty PATH [options]\n"
      "       virtual_board --usb[=SERIAL] [options] -- COMMAND [ARGUMENTS]\n"
      "A board that is a program. With --pty it is the serial line PATH (a symbolic link to a\n"
      "pseudo terminal), open to any program as serial:PATH. With --usb it is an emulated FT232H\n"
      "that COMMAND, and all that it starts, sees in place of this machine's USB devices; the\n"
      "exit code is that of COMMAND. Ends on Ctrl-C, and says on stderr what has happened.\n";
  const auto text = [&](const char* name, const char* value, const char* about) {
    line.options.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  const auto number = [](po::options_description& options, const char* name, const char* value,
                         const char* about) {
    options.add_options()(name, po::value<double>()->value_name(value)->default_value(0), about);
  };
  text("pty", "PATH", "reached over a pseudo terminal; prints \"ready PATH\" when it is");
  line.options.add_options()(
      "usb", po::value<std::string>()->value_name("SERIAL")->implicit_value("FS000001"),
      "reached over emulated USB, with this serial number");

  po::options_description cameras("Cameras (none: only what the host sends)");
  cameras.add_options()("images", po::value<Strings>()->multitoken()->value_name("LEFT RIGHT"),
                        "one pair of image files");
  const auto camera_text = [&](const char* name, const char* value, const char* about) {
    cameras.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  camera_text("folder", "DIR", "DIR/left and DIR/right, both sorted by name, in turns");
  camera_text("bag", "FILE", "the pairs of a bag, in turns");
  cameras.add_options()("camera",
                        po::value<std::string>()->value_name("NAME")->default_value("stereo"),
                        "of the bag: the topics are /NAME/left/image_raw and so on");
  cameras.add_options()("first", po::value<int>()->value_name("N")->default_value(200),
                        "no more than the first N pairs, which are held in memory");
  number(cameras, "rate", "HZ", "pairs per second [0 to 10000]; 0: none");
  line.options.add(cameras);
  line.options.add(engine_options());

  po::options_description faults("Faults of the line, per MiB to the host on average");
  for (int i = 0; i < sim::kNumLineFaults; ++i) {
    static const char* const kAbout[] = {"bits flipped",
                                         "bytes lost",
                                         "bytes inserted",
                                         "bytes doubled",
                                         "packets lost",
                                         "packets doubled",
                                         "packets swapped",
                                         "packets that lack their end",
                                         "times garbage before a packet"};
    number(faults, sim::name(static_cast<sim::LineFault>(i)), "RATE", kAbout[i]);
  }
  faults.add_options()("both-ways", po::bool_switch(), "the same rates for what the host sends");
  faults.add_options()("seed", po::value<std::uint64_t>()->value_name("N")->default_value(1),
                       "of all that is random");
  line.options.add(faults);

  po::options_description events("Faults in time");
  const auto event_text = [&](const char* name, const char* value, const char* about) {
    events.add_options()(name, po::value<std::string>()->value_name(value), about);
  };
  event_text("unplug", "S:MS", "the cable is pulled every S seconds, for MS milliseconds");
  event_text("stall", "S:MS", "nothing passes every S seconds, for MS milliseconds");
  event_text("reset", "S", "the board is reset in mid-frame every S seconds");
  event_text("halt", "S", "USB: the endpoint halts every S seconds");
  event_text("empty", "S:N", "USB: every S seconds N transfers without a byte");
  events.add_options()("short", po::value<int>()->value_name("BYTES")->default_value(0),
                       "USB: packets have no more than so many bytes [0 to 510]; 0: as usual");
  number(events, "slow", "BYTES", "the host takes so many bytes per second; 0: all");
  event_text("script", "FILE", "events of a file; -: of standard input, as they come");
  line.options.add(events);
  line.notes = std::string("\n") + kScriptHelp;
  return line;
}

std::vector<sim::GreyPair> read_cameras(const po::variables_map& options) {
  const bool images = options.count("images") != 0;
  const bool folder = options.count("folder") != 0;
  const bool bag = options.count("bag") != 0;
  if (images + folder + bag > 1) {
    throw UsageError("--images, --folder and --bag: allowed is one of them");
  }
  const double rate = options["rate"].as<double>();
  require_range("--rate", rate, 0, 10000);
  const int first = options["first"].as<int>();
  require_range("--first", first, 1, 1000000);
  const auto most = static_cast<std::size_t>(first);
  if (rate > 0 && images + folder + bag == 0) {
    throw UsageError("--rate is given without --images, --folder or --bag");
  }
  if (folder) return read_folder(options["folder"].as<std::string>(), most);
  if (bag) {
    return read_bag(options["bag"].as<std::string>(), options["camera"].as<std::string>(), most);
  }
  if (!images) return {};
  const Strings paths = options["images"].as<Strings>();
  if (paths.size() != 2) {
    throw UsageError(concat("--images has ", paths.size(), " files: allowed 2, LEFT and RIGHT"));
  }
  return read_image_pair(paths[0], paths[1]);
}

sim::FaultyBoard::Options line_faults(const po::variables_map& options) {
  sim::FaultyBoard::Options made;
  for (int i = 0; i < sim::kNumLineFaults; ++i) {
    const std::string name = sim::name(static_cast<sim::LineFault>(i));
    const double rate = options[name].as<double>();
    require_range("--" + name, rate, 0, 1 << 20);
    made.to_host[static_cast<std::size_t>(i)] = rate;
  }
  if (options["both-ways"].as<bool>()) made.from_host = made.to_host;
  made.seed = options["seed"].as<std::uint64_t>();
  made.bytes_per_s = options["slow"].as<double>();
  require_range("--slow", made.bytes_per_s, 0, 1e12);
  return made;
}

void add_periodic(const po::variables_map& options, Events& events) {
  for (const std::string name : {"unplug", "stall", "reset", "halt", "empty"}) {
    if (options.count(name) == 0) continue;
    const std::string given = options[name].as<std::string>();
    const std::size_t colon = given.find(':');
    std::string text = concat("at ", given.substr(0, colon), " ", name);
    if (colon != std::string::npos) text += " " + given.substr(colon + 1);
    const auto parsed = parse_script_line(text);
    if (*parsed->at <= 0) throw UsageError(concat("--", name, " = \"", given, "\": not every 0 s"));
    events.add_periodic(*parsed->at, parsed->event);
  }
  if (options.count("script") != 0) events.add_script(options["script"].as<std::string>());
}

std::unique_ptr<Line> make_line(const po::variables_map& options, sim::FaultyBoard& board,
                                const Strings& command) {
  const bool usb = options.count("usb") != 0;
  if (usb == (options.count("pty") != 0)) throw UsageError("allowed is one of --pty and --usb");
  if (usb == command.empty()) {
    throw UsageError(usb ? "--usb needs -- COMMAND, which is to see the board"
                         : "-- COMMAND is for --usb only");
  }
  for (const char* other : {"halt", "empty"}) {
    if (!usb && options.count(other) != 0) throw UsageError(concat("--", other, " needs --usb"));
  }
  const int most = options["short"].as<int>();
  require_range("--short", most, 0, 510);
  if (!usb) {
    if (most != 0) throw UsageError("--short needs --usb");
    return make_pty_line(board, options["pty"].as<std::string>());
  }
  auto line = make_usb_line(board, options["usb"].as<std::string>(), command);
  line->limit_packets(most);
  return line;
}

/// Everything, until it ends: the exit code.
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

  int run() {
    if (!line_->ready().empty()) std::cout << "ready " << line_->ready() << std::endl;
    const auto start = Clock::now();
    auto last = start;
    std::optional<int> ended;
    while (!ended && !interrupted()) {
      const auto now = Clock::now();
      const auto passed = std::chrono::duration_cast<std::chrono::microseconds>(now - last);
      last += passed;
      board_.run(passed);
      const double seconds = std::chrono::duration<double>(now - start).count();
      if (!events_.run(seconds, board_, *line_)) break;
      feed(seconds);
      line_->serve(wait(start));
      ended = line_->ended();
    }
    if (!ended && interrupted()) ended = line_->ended();
    return ended.value_or(kSuccess);
  }

  std::string statistics() const;

 private:
  void feed(double now) {
    if (rate_ <= 0 || now < next_frame_) return;
    board_.feed(pairs_[fed_++ % pairs_.size()]);
    next_frame_ += 1 / rate_;
    // Cameras do not wait for a board that is too slow.
    if (next_frame_ >= now) return;
    const double missed = std::ceil((now - next_frame_) * rate_);
    late_ += static_cast<std::uint64_t>(missed);
    next_frame_ += missed / rate_;
  }
  /// Until something is due.
  milliseconds wait(Clock::time_point start) const {
    const double now = std::chrono::duration<double>(Clock::now() - start).count();
    const double due = std::min(events_.next(), rate_ > 0 ? next_frame_ : now + 1);
    const double ms = std::clamp((due - now) * 1e3, 0.0, static_cast<double>(kLongestWait.count()));
    return milliseconds(static_cast<int>(std::ceil(ms)));
  }

  const std::vector<sim::GreyPair> pairs_;
  const double rate_;
  Engine engine_;
  sim::FaultyBoard board_;
  Events events_;
  std::unique_ptr<Line> line_;  // before the board goes
  double next_frame_ = 0;       // s since the start
  std::uint64_t fed_ = 0, late_ = 0;
};

std::string VirtualBoard::statistics() const {
  const sim::FaultyBoard::Counts counts = board_.counts();
  std::ostringstream text;
  text << "virtual_board: " << fed_ << " pairs from the cameras, " << late_
       << " left out because the engine was too slow\n";
  if (engine_.peek) {
    text << "virtual_board: " << engine_.peek(spec::kRegFramesDropped)
         << " frames dropped because the host took none since the last reset\n";
  }
  text << "virtual_board: " << counts.to_host << " bytes to the host, " << counts.from_host
       << " from it, " << counts.lost << " lost for want of one\n"
       << "virtual_board: " << counts.resets << " resets, " << events_.unplugged()
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
