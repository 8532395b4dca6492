// libFuzzer target for the decoder and the frame assembler. The first byte of the input selects
// whether the rest is a byte stream or the contents of packets with right CRCs, which a fuzzer
// cannot guess. Run by test/fuzz.
#include <algorithm>
#include <cstdlib>

#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"

namespace {

using fpga_stereo::link::AssembledFrame;
using fpga_stereo::link::Decoder;
using fpga_stereo::link::FrameAssembler;
using fpga_stereo::link::Header;

/// Makes packets from the input: 8 bytes for type, stream, index, size, frame_id; then the payload.
std::vector<std::uint8_t> packets(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint8_t> stream;
  while (size >= 8) {
    Header header;
    header.type = static_cast<fpga_stereo::link::PacketType>(data[0]);
    header.stream = static_cast<fpga_stereo::link::Stream>(data[1]);
    header.index = fpga_stereo::link::get_u16(data + 2);
    header.frame_id = data[6];
    header.sequence = data[7];
    const std::size_t length = std::min<std::size_t>(
        size - 8, fpga_stereo::link::get_u16(data + 4) % fpga_stereo::link::kMaxPayloadBytes);
    fpga_stereo::link::append_packet(header, data + 8, length, stream);
    data += 8 + length;
    size -= 8 + length;
  }
  return stream;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::vector<std::uint8_t> stream = (data[0] & 1) != 0
                                               ? packets(data + 2, size - 2)
                                               : std::vector<std::uint8_t>(data + 2, data + size);
  const std::size_t piece = 1 + data[1];
  Decoder decoder;
  FrameAssembler assembler(FrameAssembler::Options{(data[0] & 2) != 0});
  std::vector<AssembledFrame> frames;
  std::uint64_t in_packets = 0;
  const auto take_out = [&] {
    while (const auto packet = decoder.next()) {
      const auto header = fpga_stereo::link::pack(packet->header);
      in_packets += header.size() + packet->header.length + fpga_stereo::link::kCrcBytes;
      assembler.add(*packet, frames);
    }
  };
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    decoder.push(stream.data() + at, std::min(piece, stream.size() - at));
    take_out();
  }
  for (std::size_t i = 0; i <= stream.size(); ++i) {
    decoder.discard_partial_packet();
    take_out();
  }
  assembler.reset(frames);
  // Every byte must be in a packet or skipped, and every frame must be possible.
  if (in_packets + decoder.counters().skipped_bytes != stream.size()) std::abort();
  for (const AssembledFrame& frame : frames) {
    if (frame.verdict == link::FrameVerdict::kGood && (frame.flags != 0 || frame.missing_rows != 0))
      std::abort();
    if (frame.text().empty()) std::abort();
  }
  return 0;
}
