// board capture.
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

constexpr std::chrono::milliseconds kLook{50};

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: board capture [DEVICE] N --out FOLDER [options]\n"
      "Writes N sets of frames, each of one pair of images, all streams of it whole:\n"
      "  FOLDER/STREAM/ID.png  disparity as match writes it (16 bit, 1/32 px, 65535 = none),\n"
      "                        all others grey; ID is the frame's number\n"
      "  FOLDER/frames.csv     a line for each set that came, also of those that lack something:\n"
      "                        frame_id, configuration, time of the board in us (mid-exposure),\n"
      "                        stamp in s of this machine (none of a recording), why it was not\n"
      "                        written\n"
      "The board computes with what it was last configured with: see board upload. DEVICE may be\n"
      "replay:FILE.\n";
  line.positional = {"N"};
  line.options.add_options()("out", po::value<std::string>()->value_name("FOLDER"),
                             "where to, made if need be");
  line.options.add_options()("timeout", po::value<double>()->value_name("S")->default_value(10),
                             "seconds without a whole set, after which it fails [0.1 to 86400]");
  add_frame_options(line.options, "disparity");
  return line;
}

/// The frames of a capture in its folder.
class Folder {
 public:
  Folder(std::string path, link::StreamSet streams) : path_(std::move(path)), streams_(streams) {
    create_folder(path_);
    for (const StreamName& each : kStreamNames) {
      if (streams_.contains(each.stream)) create_folder(path_ + "/" + each.name);
    }
    table_.open(path_ + "/frames.csv");
    table_ << "frame_id,configuration,board_us,stamp,dropped\n";
    check();
  }

  /// Whether all of its streams were there, and it was written.
  bool add(const ArrivedFrames& frames) {
    std::string why;
    for (const std::string& dropped : frames.set.dropped) {
      why += (why.empty() ? "" : "; ") + dropped;
    }
    for (const StreamName& each : kStreamNames) {
      const bool lacks = streams_.contains(each.stream) && frames.set.image(each.stream).empty();
      if (lacks && why.empty()) why = concat("no ", each.name, " frame came");
    }
    table_ << frames.set.frame_id << "," << frames.set.configuration << "," << frames.set.timestamp
           << ",";
    if (frames.stamp) table_ << std::fixed << std::setprecision(6) << *frames.stamp;
    table_ << ",\"" << why << "\"\n";
    check();
    if (!why.empty()) return false;
    std::ostringstream name;
    name << std::setw(20) << std::setfill('0') << frames.set.frame_id << ".png";
    for (const StreamName& each : kStreamNames) {
      if (!streams_.contains(each.stream)) continue;
      write_image(path_ + "/" + each.name + "/" + name.str(), frames.set.image(each.stream));
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

void capture(const std::string& device, const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  const int wanted = parse_count(parsed->positional[0]);
  if (options.count("out") == 0) throw UsageError("--out is missing: the folder for the frames");
  const double timeout = options["timeout"].as<double>();
  require_range("--timeout", timeout, 0.1, 86400);
  const link::StreamSet streams = parse_streams(options["streams"].as<std::string>());

  const auto source = open_frames(device, streams, patience(options));
  Folder folder(options["out"].as<std::string>(), streams);
  Tally tally(*source, streams);
  int written = 0;
  double last = 0;
  while (written < wanted && !interrupted() && !source->ended()) {
    for (const ArrivedFrames& frames : source->take(kLook)) {
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
  const std::string why =
      source->ended() ? "the recording has ended" : concat("no whole set came for ", timeout, " s");
  const std::string trouble = source->snapshot().trouble_text;
  throw std::runtime_error(concat("captured ", written, " of ", wanted, " sets of frames: ", why,
                                  trouble.empty() ? "" : " (" + trouble + ")"));
}

}  // namespace fpga_stereo::tools
