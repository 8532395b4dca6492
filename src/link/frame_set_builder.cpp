#include "link/frame_set_builder.hpp"

#include <utility>

namespace fpga_stereo::link {

void FrameSetBuilder::add(const Packet& packet, StreamSet expected, std::vector<FrameSet>& out) {
  const Header& header = packet.header;
  assembler_.add(packet, assembled_);
  collect(expected, out);
  if (header.type == PacketType::kLeader &&
      assembler_.frame_in_flight(header.stream) == header.frame_id) {
    collector_.begin(header.stream, header.frame_id, out);
  }
}

void FrameSetBuilder::end(std::vector<FrameSet>& out) {
  assembler_.reset(assembled_);
  collect({}, out);
  collector_.reset(out);
}

void FrameSetBuilder::collect(StreamSet expected, std::vector<FrameSet>& out) {
  for (AssembledFrame& frame : assembled_) collector_.add(std::move(frame), expected, out);
  assembled_.clear();
}

}  // namespace fpga_stereo::link
