// board capture.
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <iostream>

#include "board/modes.hpp"
#include "board/streams.hpp"
#include "board/tally.hpp"
#include "support/files.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

constexpr std::chrono::milliseconds kPollPeriod{50};

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: board capture [DEVICE] N --out FOLDER [options]\n"
      "Writes N complete frame sets. A frame set is all frames that the board made from one pair.\n"
      "  FOLDER/STREAM/1.png   disparity as match writes it (16 bit, 1/32 px, 65535 = none), "
      "other\n"
      "                        streams in grey; the names are 1 to N, with leading zeros if N is\n"
      "                        above 9\n"
      "  FOLDER/frames.csv     one line per frame set, including incomplete ones: file (empty if "
      "it\n"
      "                        was not written), frame id, configuration id, board time in us\n"
      "                        (mid-exposure), stamp of this machine in s (empty for recordings),\n"
      "                        reason if it was not written\n"
      "The board uses the configuration of the last board upload. DEVICE may be replay:FILE.\n";
  line.positional = {"N"};
  line.options.add_options()("out", po::value<std::string>()->value_name("FOLDER"),
                             "folder to write to, created if necessary");
  line.options.add_options()(
      "timeout", po::value<double>()->value_name("S")->default_value(10),
      "fail after this many seconds without a complete frame set [0.1 to 86400]");
  add_frame_options(line, "disparity");
  return line;
}

/// Writes captured frames to a folder.
class CaptureFolder {
 public:
  /// `count`: how many frame sets will be written at most.
  CaptureFolder(std::string path, link::StreamSet streams, int count)
      : path_(std::move(path)), streams_(streams), digits_(std::to_string(count).size()) {
    create_folder(path_);
    for (const StreamName& each : kStreamNames) {
      if (streams_.contains(each.stream)) create_folder(path_ + "/" + each.name);
    }
    table_.open(path_ + "/frames.csv");
    table_ << "file,frame_id,configuration,board_us,stamp,dropped\n";
    check();
  }

  /// Records a frame set, and writes it if it is complete. Returns whether it did.
  bool add(const ArrivedFrames& frames) {
    std::string reason;
    for (const std::string& dropped : frames.set.dropped) {
      reason += (reason.empty() ? "" : "; ") + dropped;
    }
    for (const StreamName& each : kStreamNames) {
      const bool is_missing =
          streams_.contains(each.stream) && frames.set.image(each.stream).empty();
      if (is_missing && reason.empty()) reason = fmt::format("no {} frame came", each.name);
    }
    const std::string file = reason.empty() ? fmt::format("{:0{}}.png", ++written_, digits_) : "";
    table_ << file << "," << frames.set.frame_id << "," << frames.set.configuration << ","
           << frames.set.timestamp << ",";
    if (frames.stamp) table_ << std::fixed << std::setprecision(6) << *frames.stamp;
    table_ << ",\"" << reason << "\"\n";
    check();
    if (!reason.empty()) return false;
    for (const StreamName& each : kStreamNames) {
      if (!streams_.contains(each.stream)) continue;
      write_image(path_ + "/" + each.name + "/" + file, frames.set.image(each.stream));
    }
    return true;
  }

 private:
  void check() {
    table_.flush();
    if (!table_) {
      throw std::runtime_error(path_ + "/frames.csv: cannot be written: " + std::strerror(errno));
    }
  }

  const std::string path_;
  const link::StreamSet streams_;
  const std::size_t digits_;  // of the file names
  int written_ = 0;
  std::ofstream table_;
};

int parse_count(const std::string& text) {
  const bool digits =
      !text.empty() && text.size() < 8 && text.find_first_not_of("0123456789") == std::string::npos;
  const int count = digits ? std::stoi(text) : 0;
  if (count > 0) return count;
  throw UsageError("N = \"" + text + "\": allowed 1 to 9999999");
}

}  // namespace

void capture(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const int wanted = parse_count(parsed->positional[0]);
  if (options.count("out") == 0)
    throw UsageError("--out is missing: it names the folder for the frames");
  const double timeout = options["timeout"].as<double>();
  require_range("--timeout", timeout, 0.1, 86400);
  const link::StreamSet streams = parse_streams(options["streams"].as<std::string>());

  const auto source = open_frames(device_of(*parsed), streams, patience(options));
  CaptureFolder folder(options["out"].as<std::string>(), streams, wanted);
  Tally tally(*source, streams);
  int written = 0;
  double last = 0;
  while (written < wanted && !interrupted() && !source->has_ended()) {
    for (const ArrivedFrames& frames : source->take(kPollPeriod)) {
      if (written == wanted) break;
      tally.add(frames);
      if (!folder.add(frames)) continue;
      ++written;
      last = tally.seconds();
    }
    if (tally.seconds() - last > timeout) break;
  }
  std::cout << tally.text(*source);
  if (written == wanted || interrupted()) return;
  const std::string why = source->has_ended()
                              ? "the recording has ended"
                              : fmt::format("no complete frame set came for {:g} s", timeout);
  const std::string trouble = source->snapshot().trouble_text;
  throw std::runtime_error(fmt::format("captured {} of {} frame sets: {}{}", written, wanted, why,
                                       trouble.empty() ? "" : " (" + trouble + ")"));
}

}  // namespace fpga_stereo::tools
