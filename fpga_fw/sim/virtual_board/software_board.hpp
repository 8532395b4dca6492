// A board whose gateware is the software pipeline: for full rate, and for what hardware does not do
// on demand. The packets and registers are those of fpga_fw/spec/link.md.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <vector>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"
#include "link/request.hpp"
#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

class SoftwareBoard : public Board {
 public:
  struct Options {
    GatewareBuild build;
    link::StreamSet streams = link::StreamSet::all();  // that it can send, or take
    std::uint32_t clock_hz = 100000000;                // that it says it has
    std::size_t most_waiting = 8 << 20;  // bytes for the host: a frame behind them is dropped
    std::size_t payload = 4096;          // bytes: rows go in packets of so many
    int num_threads = 1;
    /// What was made of a pair is kept: pairs that come again cost no computation.
    std::size_t kept_pairs = 0;
    /// Registers that hold this, whatever is written: wrong identity, version, hash; defects.
    std::map<std::uint32_t, std::uint32_t> wrong;
    std::uint8_t version = kLinkVersion;  // of its packets
    int wrong_pixels = 0;                 // so many disparities of a frame are not the pipeline's
    Options();
  };

  SoftwareBoard() : SoftwareBoard(Options{}) {}
  explicit SoftwareBoard(const Options& options);

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  void feed(const GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

  std::uint32_t peek(std::uint32_t address) const;
  /// A frame is under way, and does not end: an apply waits for its end.
  void hold_frame(bool held);

 private:
  /// What the pipeline made of a pair.
  struct Made {
    GreyPair raw;
    cv::Mat1b left, right;
    cv::Mat1w disparity;
  };

  void take(const link::Packet& packet);
  void answer(const link::Header& request, link::PacketType type,
              const std::vector<std::uint8_t>& payload);
  void refuse(const link::Header& request, std::uint32_t why);
  void write(std::uint32_t address, std::uint32_t value);
  void apply();
  void take_input(const link::Packet& packet);
  void frame(const GreyPair& pair, std::uint64_t frame_id, std::uint64_t timestamp,
             std::uint32_t flags);
  const Made& make(const GreyPair& pair);
  void send(link::Stream stream, const cv::Mat& image, std::uint64_t frame_id,
            std::uint64_t timestamp, std::uint32_t flags);
  bool host_alive() const;

  Options options_;
  std::array<std::uint32_t, 256> registers_{};
  std::array<std::vector<std::uint32_t>, 2> mesh_;  // shadow, by node
  bool mesh_written_ = false;
  bool frame_held_ = false;

  // In effect.
  Parameters parameters_;
  StereoRectification rectification_;
  std::uint32_t frame_flags_ = 0;
  std::array<std::vector<std::uint32_t>, 2> active_mesh_;

  std::uint64_t time_us_ = 0;
  std::uint64_t last_byte_ = 0, last_heard_ = 0, next_heartbeat_ = 0;
  bool heard_ = false;
  std::uint64_t next_frame_ = 0;
  std::uint64_t pairs_ = 0, sent_pairs_ = 0;
  std::uint32_t sequence_ = 0;
  link::Decoder decoder_;
  link::FrameAssembler input_;
  std::vector<link::AssembledFrame> pairs_in_;
  std::vector<std::uint8_t> waiting_;
  std::size_t taken_ = 0;  // of waiting_
  Pipeline pipeline_;
  std::deque<Made> made_;
};

}  // namespace fpga_stereo::sim
