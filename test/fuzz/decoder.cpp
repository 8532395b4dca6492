// libFuzzer target for the decoder, frames and frame sets. The first byte of the input selects
// whether the rest is a byte stream or the contents of packets with right CRCs, which a fuzzer
// cannot guess.
#include "link/decoder.hpp"

#include <algorithm>

#include "fuzz/budget.hpp"
#include "link/frame_set_builder.hpp"

namespace {

using fpga_stereo::link::Decoder;
using fpga_stereo::link::FrameAssembler;
using fpga_stereo::link::FrameSet;
using fpga_stereo::link::FrameSetBuilder;
using fpga_stereo::link::Header;
using fpga_stereo::test::require;

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
  const fpga_stereo::test::Budget budget(stream.size());
  Decoder decoder;
  FrameSetBuilder builder(FrameAssembler::Options{(data[0] & 2) != 0});
  std::vector<FrameSet> sets;
  std::uint64_t in_packets = 0;
  const auto take_out = [&] {
    while (const auto packet = decoder.next()) {
      in_packets +=
          fpga_stereo::link::kHeaderBytes + packet->header.length + fpga_stereo::link::kCrcBytes;
      builder.add(*packet, fpga_stereo::link::Stream::kDisparity, sets);
    }
  };
  for (std::size_t at = 0; at < stream.size(); at += piece) {
    decoder.push(stream.data() + at, std::min(piece, stream.size() - at));
    take_out();
  }
  std::uint64_t before = 0;
  do {
    before = decoder.counters().skipped_bytes;
    decoder.discard_partial_packet();
    take_out();
  } while (decoder.counters().skipped_bytes != before);
  builder.end(sets);
  require(in_packets + decoder.counters().skipped_bytes == stream.size(),
          "every byte is in a packet or skipped");
  for (const FrameSet& set : sets) {
    require(set.dropped.size() == set.verdicts.size(), "every verdict has a text");
    std::size_t images = 0;
    for (const cv::Mat& image : set.images) images += image.empty() ? 0 : 1;
    require(images + set.dropped.size() > 0, "a set has a frame or a loss");
  }
  require(sets.size() <= in_packets, "sets come from packets");
  return 0;
}
