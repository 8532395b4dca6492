#include "board/frames.hpp"

#include <fmt/format.h>

#include "board/build.hpp"
#include "board/streams.hpp"
#include "fpga_stereo/core/spec.hpp"
#include "fpga_stereo/link/recording_player.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;
using std::chrono::milliseconds;

class BoardFrames : public FrameSource {
 public:
  BoardFrames(const std::string& device, link::StreamSet streams, const Patience& patience,
              const Connection::Wrap& wrap, const Configure& configure)
      : board_(device, patience, wrap) {
    const link::Identity identity = board_.identify();
    for (const StreamName& each : kStreamNames) {
      if (!streams.contains(each.stream) || identity.supports(each.stream)) continue;
      throw std::runtime_error(fmt::format("the gateware was not built with stream {}", each.name));
    }
    if (configure) {
      apply_configuration(board_, configure(identity), 0, streams, false, kConfigurationTimeout);
      return;
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

class RecordedFrames : public FrameSource {
 public:
  RecordedFrames(const std::string& device, link::StreamSet streams) {
    auto opened = link::RecordingPlayer::open(device, streams);
    if (!opened && opened.error().kind == ErrorKind::kInvalid) {
      throw UsageError(opened.error().message);
    }
    require(opened);
    player_ = std::move(*opened);
  }

  std::vector<ArrivedFrames> take(milliseconds timeout) override {
    auto played = player_->take(timeout);
    std::vector<ArrivedFrames> frames;
    if (!played) {
      has_ended_ = played.error().kind == ErrorKind::kUnplugged;
      if (!has_ended_) require(played);
      return frames;
    }
    for (auto& each : *played) frames.push_back({std::move(each.set), std::nullopt, 0});
    return frames;
  }
  bool has_ended() const override { return has_ended_; }
  link::Device::Snapshot snapshot() const override {
    link::Device::Snapshot now;
    now.description = player_->description();
    now.decoder = player_->decoder_counters();
    now.frames = player_->frame_counters();
    now.transport = player_->transport_counters();
    return now;
  }

 private:
  std::unique_ptr<link::RecordingPlayer> player_;
  bool has_ended_ = false;
};

}  // namespace

void add_frame_options(CommandLine& line, const std::string& default_streams) {
  line.options.add_options()(
      "streams", po::value<std::string>()->value_name("NAMES")->default_value(default_streams),
      "comma-separated: disparity, left, right, raw_left, raw_right (left and right are "
      "rectified)");
  add_patience(line);
}

std::unique_ptr<FrameSource> open_frames(const std::string& device, link::StreamSet streams,
                                         const Patience& patience, const Connection::Wrap& wrap,
                                         const Configure& configure) {
  if (device.compare(0, 7, "replay:") == 0) {
    return std::make_unique<RecordedFrames>(device, streams);
  }
  return std::make_unique<BoardFrames>(device, streams, patience, wrap, configure);
}

}  // namespace fpga_stereo::tools
