// Statistics of a link over a period of time.
#pragma once

#include <array>
#include <chrono>
#include <map>
#include <string>
#include <vector>

#include "board/frames.hpp"

namespace fpga_stereo::tools {

class Tally {
 public:
  Tally(const FrameSource& source, link::StreamSet streams);

  void add(const ArrivedFrames& frames);
  double seconds() const;
  /// Returns the statistics as a table with one line per topic.
  std::string text(const FrameSource& source) const;

 private:
  const link::StreamSet streams_;
  const link::Device::Snapshot start_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::array<std::uint64_t, link::kNumStreams> frames_{};
  std::map<link::FrameVerdict, std::uint64_t> dropped_;
  std::vector<double> latencies_;  // ms
};

}  // namespace fpga_stereo::tools
