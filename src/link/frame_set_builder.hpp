// From the packets of frames to frame sets.
#pragma once

#include <vector>

#include "link/frame_assembler.hpp"
#include "link/frame_set_collector.hpp"

namespace fpga_stereo::link {

class FrameSetBuilder {
 public:
  FrameSetBuilder() = default;
  explicit FrameSetBuilder(FrameAssembler::Options options) : assembler_(options) {}

  /// Adds a leader, rows or a trailer. Appends the frame sets that are complete to `out`; a
  /// complete set has the `expected` streams and those that have begun. Takes time and memory in
  /// proportion to the packet, whatever it holds.
  void add(const Packet& packet, StreamSet expected, std::vector<FrameSet>& out);
  /// Ends the frames in flight and appends all sets, because the link was lost.
  void end(std::vector<FrameSet>& out);

  const FrameCounters& counters() const { return assembler_.counters(); }

 private:
  void collect(StreamSet expected, std::vector<FrameSet>& out);

  FrameAssembler assembler_;
  FrameSetCollector collector_;
  std::vector<AssembledFrame> assembled_;
};

}  // namespace fpga_stereo::link
