// board measure and board record.
#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iostream>

#include "board/build.hpp"
#include "board/modes.hpp"
#include "board/streams.hpp"
#include "board/tally.hpp"
#include "link/recording.hpp"
#include "support/interrupt.hpp"

namespace fpga_stereo::tools {
namespace {

using link::Recorder;
using link::Transport;

constexpr std::chrono::milliseconds kPollPeriod{50};

double parse_seconds(const std::string& text) {
  std::istringstream in(text);
  double seconds = 0;
  if ((in >> seconds) && in.eof() && seconds > 0 && seconds <= 1e7) return seconds;
  throw UsageError(fmt::format("SECONDS = \"{}\": allowed above 0 and up to 10000000", text));
}

/// Returns SECONDS from the argument after the first `before`; 0 if it is missing.
double seconds_of(const Parsed& parsed, std::size_t before) {
  const auto& given = parsed.positional;
  if (given.size() > before + 1) {
    throw UsageError(fmt::format("argument \"{}\" is one too many", given[before + 1]));
  }
  return given.size() > before ? parse_seconds(given[before]) : 0;
}

void run(FrameSource& source, link::StreamSet streams, double seconds) {
  Tally tally(source, streams);
  while (!interrupted() && !source.has_ended() && (seconds <= 0 || tally.seconds() < seconds)) {
    for (const ArrivedFrames& frames : source.take(kPollPeriod)) tally.add(frames);
  }
  std::cout << tally.text(source);
}

/// The recordings of one run: each time the link is opened, a new file begins: FILE, FILE.2,
/// FILE.3. Only the thread of the device uses it until the device is destroyed.
struct Recordings {
  std::string path;
  int count = 0;
  Status status;  // the last failure
};

/// A recorder that stores its final status.
class Recording : public Transport {
 public:
  Recording(std::unique_ptr<Recorder> recorder, std::shared_ptr<Recordings> all)
      : recorder_(std::move(recorder)), all_(std::move(all)) {}
  ~Recording() override {
    if (const Status status = recorder_->status(); !status) all_->status = status;
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
  auto recorder = Recorder::open(
      std::move(inner), all->count == 1 ? all->path : fmt::format("{}.{}", all->path, all->count));
  if (!recorder) return recorder.error();
  return std::unique_ptr<Transport>(std::make_unique<Recording>(std::move(*recorder), all));
}

}  // namespace

void measure(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board measure [DEVICE] [SECONDS] [options]\n"
      "Measures the link for SECONDS or until Ctrl-C: bytes, frames per stream, dropped frames "
      "with\n"
      "causes, bad and lost packets, latency, clocks and watchdog. DEVICE may be replay:FILE, "
      "which is\n"
      "measured to its end. The board uses the configuration of the last board upload.\n";
  line.rest = "SECONDS";
  add_frame_options(line, "disparity");
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  const double seconds = seconds_of(*parsed, 0);
  const link::StreamSet streams = parse_streams(parsed->options["streams"].as<std::string>());
  const auto source = open_frames(device_of(*parsed), streams, patience(parsed->options));
  run(*source, streams, seconds);
}

void record(const Arguments& arguments) {
  CommandLine line;
  line.usage =
      "Usage: board record [DEVICE] FILE [SECONDS] [options]\n"
      "Turns on streams and records all bytes of the link, in both directions, to FILE for "
      "SECONDS\n"
      "or until Ctrl-C; then prints the same as measure. If the link is lost and reopened, a new "
      "file\n"
      "begins: FILE.2, FILE.3. Play a file with board measure or capture replay:FILE, or in the "
      "node as\n"
      "the device replay:FILE. The node publishes the recorded disparity only if it knows how it "
      "was made:\n"
      "--left-info, --right-info and parameters configure the board first, as board upload does, "
      "and so\n"
      "record the configuration. fpga_fw/spec/link.md defines the format.\n";
  line.positional = {"FILE"};
  line.takes_files = true;
  line.rest = "SECONDS";
  add_frame_options(line, "disparity");
  add_configuration_options(line);
  const auto parsed = parse(line, arguments);
  if (!parsed) return;
  const double seconds = seconds_of(*parsed, 1);
  Configure configure;
  if (check_configuration_options(parsed->options)) {
    configure = [&](const link::Identity& identity) {
      return board_configuration(parsed->options, identity.build).gateware;
    };
  }
  const link::StreamSet streams = parse_streams(parsed->options["streams"].as<std::string>());
  const std::string device = device_of(*parsed);
  if (device.compare(0, 7, "replay:") == 0) throw UsageError(device + " is a recording already");
  auto recordings = std::make_shared<Recordings>();
  recordings->path = parsed->positional[0];
  if (!std::ofstream(recordings->path)) {
    throw std::runtime_error(recordings->path + ": cannot be written: " + std::strerror(errno));
  }
  auto source = open_frames(
      device, streams, patience(parsed->options),
      [recordings](std::unique_ptr<Transport> inner) {
        return record_line(std::move(inner), recordings);
      },
      configure);
  run(*source, streams, seconds);
  source.reset();  // writes the rest of the recording
  require(recordings->status);
  if (recordings->count > 1) {
    std::cout << fmt::format("the link was opened {0} times; the last recording is {1}.{0}\n",
                             recordings->count, recordings->path);
  }
}

}  // namespace fpga_stereo::tools
