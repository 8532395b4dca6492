// board measure and board record.
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

#include "board/modes.hpp"
#include "board/streams.hpp"
#include "board/tally.hpp"
#include "link/recording.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {
namespace {

using link::Recorder;
using link::Transport;

constexpr std::chrono::milliseconds kLook{50};

double parse_seconds(const std::string& text) {
  std::istringstream in(text);
  double seconds = 0;
  if ((in >> seconds) && in.eof() && seconds > 0 && seconds <= 1e7) return seconds;
  throw UsageError("SECONDS = \"" + text + "\": allowed more than 0, up to 10000000");
}

/// `seconds` from the arguments behind the first `before`; 0: none was given.
double seconds_of(const Parsed& parsed, std::size_t before) {
  const auto& given = parsed.positional;
  if (given.size() > before + 1) {
    throw UsageError(concat("argument \"", given[before + 1], "\" is one too many"));
  }
  return given.size() > before ? parse_seconds(given[before]) : 0;
}

void run(FrameSource& source, link::StreamSet streams, double seconds) {
  Tally tally(source, streams);
  while (!interrupted() && !source.ended() && (seconds <= 0 || tally.seconds() < seconds)) {
    for (const ArrivedFrames& frames : source.take(kLook)) tally.add(frames);
  }
  std::cout << tally.text(source);
}

/// Each time the line is opened a file of its own: FILE, FILE.2, FILE.3. The thread of the line
/// has it until the line is closed for good.
struct Recordings {
  std::string path;
  int count = 0;
  Status failed;
};

/// A recorder that leaves behind how it went.
class Recording : public Transport {
 public:
  Recording(std::unique_ptr<Recorder> recorder, std::shared_ptr<Recordings> all)
      : recorder_(std::move(recorder)), all_(std::move(all)) {}
  ~Recording() override {
    if (const Status status = recorder_->status(); !status) all_->failed = status;
  }
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;
  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override {
    return recorder_->read(bytes, size, timeout);
  }
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override {
    return recorder_->write(bytes, size, timeout);
  }
  Status recover(link::Recovery step) override { return recorder_->recover(step); }
  std::string description() const override { return recorder_->description(); }
  Counters counters() const override { return recorder_->counters(); }

 private:
  const std::unique_ptr<Recorder> recorder_;
  const std::shared_ptr<Recordings> all_;
};

Result<std::unique_ptr<Transport>> record_line(std::unique_ptr<Transport> inner,
                                               const std::shared_ptr<Recordings>& all) {
  ++all->count;
  auto recorder = Recorder::open(std::move(inner),
                                 all->count == 1 ? all->path : concat(all->path, ".", all->count));
  if (!recorder) return recorder.error();
  return std::unique_ptr<Transport>(std::make_unique<Recording>(std::move(*recorder), all));
}

}  // namespace

void measure(const std::string& device, const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board measure [DEVICE] [SECONDS] [options]\n"
      "What the line carries and loses, until Ctrl-C or for SECONDS: bytes, frames per stream, "
      "what\n"
      "was dropped and why, wrong and lost packets, latency, clocks, watchdog. DEVICE may be\n"
      "replay:FILE, which is measured to its end. The board computes with what it was last\n"
      "configured with: see board upload.\n";
  line.rest = "SECONDS";
  add_frame_options(line.options, "disparity");
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  const double seconds = seconds_of(*parsed, 0);
  const link::StreamSet streams = parse_streams(parsed->options["streams"].as<std::string>());
  const auto source = open_frames(device, streams, patience(parsed->options));
  run(*source, streams, seconds);
}

void record(const std::string& device, const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board record [DEVICE] FILE [SECONDS] [options]\n"
      "Writes all bytes of the line, both ways, to FILE until Ctrl-C or for SECONDS, with these\n"
      "streams switched on, and says what measure does. Where the line is lost and opened again, "
      "a\n"
      "next file begins: FILE.2, FILE.3. Look at one with board measure or capture replay:FILE.\n"
      "The format stands in fpga_fw/spec/link.md.\n";
  line.positional = {"FILE"};
  line.rest = "SECONDS";
  add_frame_options(line.options, "disparity");
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  const double seconds = seconds_of(*parsed, 1);
  const link::StreamSet streams = parse_streams(parsed->options["streams"].as<std::string>());
  if (device.compare(0, 7, "replay:") == 0) throw UsageError(device + " is a recording already");
  auto recordings = std::make_shared<Recordings>();
  recordings->path = parsed->positional[0];
  if (!std::ofstream(recordings->path)) {
    throw std::runtime_error(recordings->path + ": cannot be written: " + std::strerror(errno));
  }
  auto source = open_frames(device, streams, patience(parsed->options),
                            [recordings](std::unique_ptr<Transport> inner) {
                              return record_line(std::move(inner), recordings);
                            });
  run(*source, streams, seconds);
  source.reset();  // what has not been written is
  require(recordings->failed);
  if (recordings->count > 1) {
    std::cout << "the line was opened " << recordings->count << " times: the last recording is "
              << recordings->path << "." << recordings->count << "\n";
  }
}

}  // namespace fpga_stereo::tools
