#include "board/frames.hpp"

#include <fmt/format.h>

#include "board/streams.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "link/frame_set_collector.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;
using std::chrono::milliseconds;

class BoardFrames : public FrameSource {
 public:
  BoardFrames(const std::string& device, link::StreamSet streams, const Patience& patience,
              const Connection::Wrap& wrap)
      : board_(device, patience, wrap) {
    const link::Identity identity = board_.identify();
    for (const StreamName& each : kStreamNames) {
      if (!streams.contains(each.stream) || identity.supports(each.stream)) continue;
      throw std::runtime_error(fmt::format("the gateware was not built with stream {}", each.name));
    }
    if (board_.read({spec::kRegConfiguration})[0] == 0) {
      throw std::runtime_error(
          "the board has not been configured since power-on: run board upload first");
    }
    link::DesiredState wanted;
    wanted.keep_configuration = true;
    wanted.streams = streams;
    board_.set_desired_state(wanted);
    const bool is_streaming = board_.wait_until(
        patience.seconds,
        [](const Connection::Snapshot& now) { return now.state == link::LinkState::kStreaming; });
    if (!is_streaming) {
      throw std::runtime_error(fmt::format("the board did not start streaming within {:g} s: {}",
                                           patience.seconds, board_.snapshot().trouble_text));
    }
  }

  std::vector<ArrivedFrames> take(milliseconds timeout) override {
    std::vector<ArrivedFrames> frames;
    for (Connection::Arrived& arrived : board_.take(timeout)) {
      frames.push_back({std::move(arrived.frames.set), arrived.frames.stamp, arrived.at});
    }
    board_.wait_until(0, [](const Connection::Snapshot&) { return true; });  // throws if refused
    return frames;
  }
  link::Device::Snapshot snapshot() const override { return board_.snapshot(); }

 private:
  Connection board_;
};

/// Plays a recording. It sends no requests, because the recorded board answered those of another
/// host.
class RecordedFrames : public FrameSource {
 public:
  RecordedFrames(const std::string& device, link::StreamSet streams)
      : line_(open_line(device)), bytes_(1 << 20), streams_(streams) {}

  std::vector<ArrivedFrames> take(milliseconds timeout) override {
    std::vector<link::FrameSet> sets;
    const auto came = line_->read(bytes_.data(), bytes_.size(), timeout);
    if (came) {
      decoder_.push(bytes_.data(), *came);
    } else if (came.error().kind == ErrorKind::kUnplugged) {
      has_ended_ = true;
      decoder_.discard_partial_packet();
    } else {
      require(came);
    }
    read_packets(sets);
    if (has_ended_) end(sets);
    std::vector<ArrivedFrames> frames;
    frames.reserve(sets.size());
    for (link::FrameSet& set : sets) frames.push_back({std::move(set), std::nullopt, 0});
    return frames;
  }
  bool has_ended() const override { return has_ended_; }
  link::Device::Snapshot snapshot() const override {
    link::Device::Snapshot now;
    now.description = line_->description();
    now.decoder = decoder_.counters();
    now.frames = assembler_.counters();
    now.transport = line_->counters();
    return now;
  }

 private:
  void read_packets(std::vector<link::FrameSet>& sets) {
    while (const auto packet = decoder_.next()) {
      const link::Stream stream = packet->header.stream;
      if (static_cast<int>(stream) >= link::kNumStreams || !streams_.contains(stream)) continue;
      assembler_.add(*packet, assembled_);
      if (packet->header.type == link::PacketType::kLeader &&
          assembler_.frame_in_flight(stream) == packet->header.frame_id) {
        sets_.begin(stream, packet->header.frame_id);
      }
      collect(sets);
    }
  }
  void collect(std::vector<link::FrameSet>& sets) {
    for (link::AssembledFrame& frame : assembled_) sets_.add(std::move(frame), streams_, sets);
    assembled_.clear();
  }
  void end(std::vector<link::FrameSet>& sets) {
    assembler_.reset(assembled_);
    collect(sets);
    sets_.reset(sets);
  }

  std::unique_ptr<link::Transport> line_;
  std::vector<std::uint8_t> bytes_;
  const link::StreamSet streams_;
  link::Decoder decoder_;
  link::FrameAssembler assembler_;
  link::FrameSetCollector sets_;
  std::vector<link::AssembledFrame> assembled_;
  bool has_ended_ = false;
};

}  // namespace

void add_frame_options(po::options_description& options, const std::string& default_streams) {
  options.add_options()(
      "streams", po::value<std::string>()->value_name("NAMES")->default_value(default_streams),
      "comma-separated: disparity, left, right, raw_left, raw_right (left and right are "
      "rectified)");
  add_patience(options);
}

std::unique_ptr<FrameSource> open_frames(const std::string& device, link::StreamSet streams,
                                         const Patience& patience, const Connection::Wrap& wrap) {
  if (device.compare(0, 7, "replay:") == 0) {
    return std::make_unique<RecordedFrames>(device, streams);
  }
  return std::make_unique<BoardFrames>(device, streams, patience, wrap);
}

}  // namespace fpga_stereo::tools
