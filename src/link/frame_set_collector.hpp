// The images that a board made of one pair, together: everything that comes from one pair has one
// stamp, and is published at once.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fpga_stereo/link/frame_set.hpp"
#include "link/frame_assembler.hpp"

namespace fpga_stereo::link {

class FrameSetCollector {
 public:
  /// More than this under way: the oldest is given as it is.
  static constexpr std::size_t kMaxInFlight = 3;

  /// A frame of a stream has begun: its set waits for it.
  void begin(Stream stream, std::uint64_t frame_id);
  /// A frame has ended, good or dropped. Sets that lack nothing are appended to `out`, in the order
  /// of their frames; `streams` has a bit for each stream that a whole set has.
  void add(AssembledFrame&& frame, StreamSet expected, std::vector<FrameSet>& out);
  /// The line was lost: what is there comes out.
  void reset(std::vector<FrameSet>& out);

 private:
  struct Entry {
    FrameSet set;
    StreamSet begun, ended;
  };
  Entry& entry(std::uint64_t frame_id);
  void give(std::size_t count, std::vector<FrameSet>& out);

  std::vector<Entry> entries_;  // by frame, the oldest first
};

}  // namespace fpga_stereo::link
