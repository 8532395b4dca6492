// The images that a board made of one pair, together: everything that comes from one pair has one
// stamp, and is published at once.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fpga_stereo/link/frame_assembler.hpp"

namespace fpga_stereo::link {

struct FrameSet {
  std::uint64_t frame_id = 0;
  std::uint64_t timestamp = 0;  // us, board clock, mid-exposure; of host frames: the host's
  std::uint32_t configuration = 0;
  // By Stream, all of one size; empty: did not come, or was dropped.
  std::array<cv::Mat, kNumStreams> images;
  std::vector<std::string> dropped;          // what was dropped and why, for people
  std::vector<Assembled::Verdict> verdicts;  // of those

  const cv::Mat& image(Stream stream) const { return images[static_cast<std::size_t>(stream)]; }
};

class FrameSets {
 public:
  /// More than this under way: the oldest is given as it is.
  static constexpr std::size_t kUnderWay = 3;

  /// A frame of a stream has begun: its set waits for it.
  void begun(Stream stream, std::uint64_t frame_id);
  /// A frame has ended, good or dropped. Sets that lack nothing are appended to `out`, in the order
  /// of their frames; `streams` has a bit for each stream that a whole set has.
  void ended(Assembled&& frame, unsigned streams, std::vector<FrameSet>& out);
  /// The line was lost: what is there comes out.
  void reset(std::vector<FrameSet>& out);

 private:
  struct Entry {
    FrameSet set;
    unsigned begun = 0, ended = 0;  // a bit per stream
  };
  Entry& entry(std::uint64_t frame_id);
  void give(std::size_t count, std::vector<FrameSet>& out);

  std::vector<Entry> entries_;  // by frame, the oldest first
};

}  // namespace fpga_stereo::link
