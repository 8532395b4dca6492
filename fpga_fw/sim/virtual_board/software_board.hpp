// A virtual board that computes with the software pipeline: as fast as the software, and with
// faults that hardware does not have on demand. It speaks the protocol of fpga_fw/spec/link.md.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "fpga_stereo/core/pipeline.hpp"
#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"
#include "link/request.hpp"
#include "sim/virtual_board/board.hpp"
#include "sim/virtual_board/board_registers.hpp"

namespace fpga_stereo::sim {

class SoftwareBoard : public Board {
 public:
  struct Options : BoardRegisters::Options {
    std::size_t max_queued_bytes = 8 << 20;  // for the host; beyond them the board drops frames
    std::size_t payload_bytes = 4096;        // size of rows packets
    int num_threads = 1;
    /// Number of pairs whose results are cached. Pairs are recognized by their data pointers.
    std::size_t cached_pairs = 1;
    std::uint8_t packet_version = kLinkVersion;
    int wrong_pixels = 0;  // disparities at the start of each frame that are falsified
    Options();
  };

  SoftwareBoard() : SoftwareBoard(Options{}) {}
  explicit SoftwareBoard(const Options& options);

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  void feed(const GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

  /// Returns the value of a register, as the board itself sees it.
  std::uint32_t peek(std::uint32_t address) const;
  /// While a frame is held in flight, an apply stays pending until it ends.
  void hold_frame(bool is_held) { registers_.hold_frame(is_held); }

 private:
  struct Outputs {
    GreyPair raw;
    cv::Mat1b left, right;  // rectified
    cv::Mat1w disparity;
  };
  /// What all images of a frame set carry.
  struct FrameHeader {
    std::uint64_t frame_id = 0, timestamp_us = 0;
    std::uint32_t flags = 0;
  };

  void handle(const link::Packet& packet);
  void handle_request(const link::Packet& packet);
  void handle_input(const link::Packet& packet);
  void answer(const link::Header& request, link::PacketType type,
              const std::vector<std::uint8_t>& payload);
  void refuse(const link::Header& request, std::uint32_t reason);

  void process(const GreyPair& pair, FrameHeader header);
  bool has_valid_size(const GreyPair& pair);
  void send_results(const GreyPair& pair, FrameHeader header);
  const Outputs& outputs_of(const GreyPair& pair);
  /// Computes the SIGNATURE registers of the last pair; called when they are read.
  void update_signatures();
  bool has_buffer_error() const;
  bool is_wanted(link::Stream stream) const;
  void send(link::Stream stream, const cv::Mat& image, const FrameHeader& header);
  bool is_host_alive() const;

  const Options options_;
  BoardRegisters registers_;
  std::uint64_t time_us_ = 0;
  std::uint64_t last_byte_us_ = 0, last_packet_us_ = 0, next_heartbeat_us_ = 0;
  bool has_heard_host_ = false;
  std::uint64_t next_frame_id_ = 0;
  std::uint64_t num_pairs_ = 0, num_sent_pairs_ = 0;
  std::uint32_t sequence_ = 0;
  link::Decoder decoder_;
  link::FrameAssembler input_;
  std::vector<link::AssembledFrame> input_frames_;
  std::vector<std::uint8_t> queue_;  // for the host
  std::size_t queue_read_ = 0;       // bytes of queue_ that the host has taken
  Pipeline pipeline_;
  std::deque<Outputs> cache_;
  std::uint32_t cached_configuration_ = 0;  // that the cache was computed with
  std::optional<GreyPair> last_pair_;       // whose signatures have not been computed
  std::uint32_t last_pair_configuration_ = 0;
};

}  // namespace fpga_stereo::sim
