// From packets to frames. A frame is a leader, packets of rows and a trailer; whatever of it is
// lost costs rows, never a wrong pixel: what comes out whole is what the board sent, or it is not
// called whole.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "link/decoder.hpp"
#include "link/packet.hpp"

namespace fpga_stereo::link {

enum class PixelFormat : std::uint8_t {
  kDisparity = kFormatDisparity,  // u16, 1/32 px, 65535 = none
  kGrey = kFormatGrey,            // u8
};

/// Payload of PacketType::kLeader:
///
///   offset  type  field
///    0      u16   width          px
///    2      u16   height         px
///    4      u8    format
///    5      u8, u16  0
///    8      u32   configuration  number of the configuration that made the frame
struct Leader {
  static constexpr std::size_t kBytes = kLinkLeaderBytes;
  std::uint16_t width = 0, height = 0;
  PixelFormat format = PixelFormat::kDisparity;
  std::uint32_t configuration = 0;

  /// Pixels in a row: of stream input those of both images, side by side.
  int columns(Stream stream) const { return stream == Stream::kInput ? 2 * width : width; }
  /// Bytes of a row in a packet of rows: the pixels, and zeros up to a multiple of 4.
  std::size_t row_bytes(Stream stream) const;
};

/// Why a board calls its own frame bad: bits of Trailer::flags.
enum FrameFlag : std::uint32_t {
  kCutFrame = kFrameCut,             // the camera's frame had too few pixels
  kLongFrame = kFrameLong,           // or too many
  kBufferError = kFrameBufferError,  // rectify read what its line buffer did not hold
  kOverrun = kFrameOverrun,          // the link was too slow: the board dropped the rest of it
};

/// Payload of PacketType::kTrailer:
///
///   offset  type  field
///    0      u32   rows           that were sent
///    4      u32   flags          FrameFlag, 0 is a good frame
///    8      u32   signature      fpga_stereo::Signature of all pixels, in raster order
struct Trailer {
  static constexpr std::size_t kBytes = kLinkTrailerBytes;
  std::uint32_t rows = 0, flags = 0, signature = 0;
};

std::array<std::uint8_t, Leader::kBytes> pack(const Leader& leader);
std::array<std::uint8_t, Trailer::kBytes> pack(const Trailer& trailer);

/// One row (8UC1 or 16UC1) as a packet of rows has it, appended to `bytes`.
void append_row(const cv::Mat& row, std::vector<std::uint8_t>& bytes);

/// A whole frame as packets, appended to `bytes`: leader, rows, trailer. `frame` has what the three
/// have in common: stream, frame_id, timestamp; and the leader's configuration. Rows go in packets
/// of at most `payload` bytes. `sequence` is that of the first packet, and moves on.
void append_frame(const Header& frame, const cv::Mat& image, std::uint32_t configuration,
                  std::uint32_t flags, std::size_t payload, std::uint32_t& sequence,
                  std::vector<std::uint8_t>& bytes);

/// What became of a frame.
struct AssembledFrame {
  FrameVerdict verdict = FrameVerdict::kGood;
  Stream stream = Stream::kNone;
  std::uint64_t frame_id = 0;
  std::uint64_t timestamp = 0;  // us, board clock, mid-exposure
  std::uint32_t configuration = 0;
  std::uint32_t flags = 0;
  int height = 0;  // px
  int missing_rows = 0;
  cv::Mat image;  // 16UC1 or 8UC1; empty if dropped

  bool is_dropped() const { return image.empty(); }
  /// For people: "disparity frame 7 dropped: 3 of 480 rows are missing".
  std::string text() const;
};

class FrameAssembler {
 public:
  struct Options {
    /// A disparity frame that lacks rows comes out as kIncomplete, those rows without disparity.
    bool keep_incomplete = false;
  };
  FrameAssembler() : FrameAssembler(Options{}) {}
  explicit FrameAssembler(Options options) : options_(options) {}

  /// Takes a leader, rows or a trailer; what it finishes is appended to `out`: none, one, or two
  /// (a leader ends the frame before). Other packets are left alone.
  void add(const Packet& packet, std::vector<AssembledFrame>& out);

  /// The link was lost: frames under way will not be finished.
  void reset(std::vector<AssembledFrame>& out);

  /// frame_id of the frame of a stream that has begun and not ended.
  std::optional<std::uint64_t> frame_in_flight(Stream stream) const;

  const FrameCounters& counters() const { return counters_; }

 private:
  struct Frame {
    bool open = false;
    Leader leader;
    AssembledFrame assembled;
    std::vector<bool> have;  // by row
  };
  void begin(const Packet& packet, Frame& frame);
  void take_rows(const Packet& packet, Frame& frame);
  void end(const Packet& packet, Frame& frame, std::vector<AssembledFrame>& out);
  void finish(Frame& frame, FrameVerdict verdict, std::vector<AssembledFrame>& out);

  Options options_;
  std::array<Frame, kNumStreams> frames_;
  FrameCounters counters_;
};

}  // namespace fpga_stereo::link
