// Sources of frames: a board or a recording.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "board/connection.hpp"

namespace fpga_stereo::tools {

struct ArrivedFrames {
  link::FrameSet set;
  std::optional<double> stamp;  // mid-exposure, s, host clock; nullopt in a recording
  double at = 0;                // arrival of the last frame, s, host clock
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// Returns the frames that arrived since the last call; blocks until some arrive or the timeout
  /// expires.
  virtual std::vector<ArrivedFrames> take(std::chrono::milliseconds timeout) = 0;
  /// Returns whether a recording has ended.
  virtual bool has_ended() const { return false; }
  /// Returns the state; for a recording only its description and counters.
  virtual link::Device::Snapshot snapshot() const = 0;
};

/// Adds DEVICE and the options --device, --streams, --wait and --verbose.
void add_frame_options(CommandLine& line, const std::string& default_streams);

/// Makes the configuration of a board that has been identified.
using Configure = std::function<GatewareConfiguration(const link::Identity&)>;

/// Opens a recording, or a board and turns on these streams, with its present configuration or that
/// of `configure`. Throws if the board is not configured or lacks a stream.
std::unique_ptr<FrameSource> open_frames(const std::string& device, link::StreamSet streams,
                                         const Patience& patience,
                                         const Connection::Wrap& wrap = nullptr,
                                         const Configure& configure = nullptr);

}  // namespace fpga_stereo::tools
