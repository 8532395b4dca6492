// What a virtual board with the software pipeline does beyond what a session asks of it.
#include "sim/virtual_board/software_board.hpp"

#include <gtest/gtest.h>

#include "fpga_stereo/core/spec.hpp"
#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"
#include "link/request.hpp"

namespace fpga_stereo::test {
namespace {

class SoftwareBoard : public ::testing::Test {
 protected:
  void send(link::Request request) {
    std::vector<std::uint8_t> bytes;
    link::Header header;
    header.type = request.type;
    header.sequence = sequence_++;
    link::append_packet(header, request.payload.data(), request.payload.size(), bytes);
    board_.receive(bytes.data(), bytes.size());
  }
  void apply() {
    send(link::write_request({{spec::kRegWidth, 40},
                              {spec::kRegHeight, 30},
                              {spec::kRegControl, spec::kControlApply.put(1)}}));
  }
  /// Returns the flags of the disparity of the next pair.
  std::uint32_t flags_of_next_frame() {
    board_.feed({cv::Mat1b(kSize, std::uint8_t{1}), cv::Mat1b(kSize, std::uint8_t{2})});
    std::vector<std::uint8_t> bytes(1 << 16);
    link::Decoder decoder;
    decoder.push(bytes.data(), board_.transmit(bytes.data(), bytes.size()));
    link::FrameAssembler assembler;
    std::vector<link::AssembledFrame> frames;
    while (const auto packet = decoder.next()) assembler.add(*packet, frames);
    EXPECT_EQ(frames.size(), 1U);
    return frames.empty() ? ~0U : frames[0].flags;
  }

  const cv::Size kSize{40, 30};
  sim::SoftwareBoard board_;
  std::uint32_t sequence_ = kLinkFirstSequence;
};

TEST_F(SoftwareBoard, FlagsFramesFromAWriteToAMeshToTheApply) {
  send(
      link::write_request({{spec::kRegStreams, link::StreamSet(link::Stream::kDisparity).bits()}}));
  apply();
  EXPECT_EQ(flags_of_next_frame(), 0U);
  for (const bool right : {false, true}) {
    send(link::mesh_request(right, {0}, 0, 1));
    EXPECT_EQ(flags_of_next_frame(), kFrameBufferError);
    EXPECT_EQ(board_.peek(spec::kRegStatus), spec::kStatusUploading.put(1));
    apply();
    EXPECT_EQ(board_.peek(spec::kRegStatus), 0U);
    EXPECT_EQ(flags_of_next_frame(), 0U);
  }
  EXPECT_EQ(board_.peek(spec::kRegMeshUploads), 2U);
  EXPECT_EQ(board_.peek(spec::kRegBufferErrors), 2U);
}

}  // namespace
}  // namespace fpga_stereo::test
