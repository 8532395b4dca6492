// Collects the frames that a board made from one pair into a frame set.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <string>
#include <vector>

#include "fpga_stereo/link/frame_set.hpp"
#include "link/frame_assembler.hpp"

namespace fpga_stereo::link {

class FrameSetCollector {
 public:
  /// Maximum frame sets in flight; beyond it the oldest is returned incomplete, or forgotten if
  /// none of its frames has ended.
  static constexpr std::size_t kMaxInFlight = 3;

  /// Notes that a frame has begun: its set waits for the frame's end. Appends sets beyond the
  /// maximum to `out`.
  void begin(Stream stream, std::uint64_t frame_id, std::vector<FrameSet>& out);
  /// Adds a frame that has ended, good or dropped. Appends the sets that are complete to `out`, in
  /// the order of their frame_ids. A complete set has the `expected` streams and those that have
  /// begun.
  void add(AssembledFrame&& frame, StreamSet expected, std::vector<FrameSet>& out);
  /// Appends all sets to `out` as they are, because the link was lost.
  void reset(std::vector<FrameSet>& out);

 private:
  struct Entry {
    FrameSet set;
    StreamSet begun, ended;
  };
  /// Returns the entry of a frame_id; creates a missing one.
  Entry& entry(std::uint64_t frame_id);
  void move_first(std::vector<FrameSet>& out);

  std::list<Entry> entries_;  // in the order of frame_id
};

}  // namespace fpga_stereo::link
