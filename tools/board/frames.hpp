// Frames as they come: from a board, or from what was recorded of one.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "board/connection.hpp"

namespace fpga_stereo::tools {

struct ArrivedFrames {
  link::FrameSet set;
  std::optional<double> stamp;  // s, host, mid-exposure; none in a recording
  double at = 0;                // s, host: when the last of it came
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// What has come; waits for some. None, and ended(), behind the end of a recording.
  virtual std::vector<ArrivedFrames> take(std::chrono::milliseconds timeout) = 0;
  virtual bool ended() const { return false; }
  /// Of a recording: line, frames and transport alone.
  virtual link::Device::Snapshot snapshot() const = 0;
};

/// --streams, --wait, --verbose.
void add_frame_options(boost::program_options::options_description& options,
                       const std::string& default_streams);

/// Switches these streams of a board on, under the configuration that it has, or opens a recording.
/// Throws where the board has no configuration or not all of the streams.
std::unique_ptr<FrameSource> open_frames(const std::string& device, link::StreamSet streams,
                                         const Patience& patience,
                                         const Connection::Wrap& wrap = nullptr);

}  // namespace fpga_stereo::tools
