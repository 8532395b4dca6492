// Assembles frames from packets: a leader, packets of rows, and a trailer. Lost packets cost rows,
// or the frame, but never make a pixel wrong: a frame called good is exactly what the board sent.
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

  /// Returns the pixels in a row; stream input has both images side by side.
  int columns(Stream stream) const { return stream == Stream::kInput ? 2 * width : width; }
  /// Returns the bytes of a row in a packet of rows: the pixels, padded with zeros to a multiple
  /// of 4.
  std::size_t row_bytes(Stream stream) const;
};

/// Why a board flags its own frame as bad: bits of Trailer::flags.
enum FrameFlag : std::uint32_t {
  kCutFrame = kFrameCut,             // the camera sent too few pixels
  kLongFrame = kFrameLong,           // the camera sent too many pixels
  kBufferError = kFrameBufferError,  // rectify lacked a pixel, or a mesh was being written
  kOverrun = kFrameOverrun,  // the link was too slow: the board dropped the rest of the frame
};

/// Payload of PacketType::kTrailer:
///
///   offset  type  field
///    0      u32   rows           sent
///    4      u32   flags          FrameFlag, 0 is a good frame
///    8      u32   signature      fpga_stereo::Signature of all pixels, in raster order
struct Trailer {
  static constexpr std::size_t kBytes = kLinkTrailerBytes;
  std::uint32_t rows = 0, flags = 0, signature = 0;
};

std::array<std::uint8_t, Leader::kBytes> pack(const Leader& leader);
std::array<std::uint8_t, Trailer::kBytes> pack(const Trailer& trailer);

/// Appends one row (8UC1 or 16UC1) to `bytes`, as packets of rows hold it.
void append_row(const cv::Mat& row, std::vector<std::uint8_t>& bytes);

/// Appends a frame to `bytes`: leader, packets of rows, trailer. `frame` gives stream, frame_id and
/// timestamp of all packets. Packets of rows have at most `payload` bytes of payload. `sequence` is
/// the first packet's sequence number, and is advanced.
void append_frame(const Header& frame, const cv::Mat& image, std::uint32_t configuration,
                  std::uint32_t flags, std::size_t payload, std::uint32_t& sequence,
                  std::vector<std::uint8_t>& bytes);

/// A frame that has ended, good or not.
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
  /// Returns a text for people: "disparity frame 7 dropped: 3 of 480 rows are missing".
  std::string text() const;
};

class FrameAssembler {
 public:
  struct Options {
    /// Returns disparity frames that lack up to half of their rows as kIncomplete; the missing rows
    /// hold no disparity. A frame that lacks more is dropped, so that the memory of frames stays in
    /// proportion to the bytes received.
    bool keep_incomplete = false;
  };
  FrameAssembler() : FrameAssembler(Options{}) {}
  explicit FrameAssembler(Options options) : options_(options) {}

  /// Adds a leader, rows or a trailer; ignores other packets. Appends the frames that end with it
  /// to `out`: a trailer ends its frame, a leader ends the last frame of its stream.
  void add(const Packet& packet, std::vector<AssembledFrame>& out);

  /// Ends the frames in flight, because the link was lost.
  void reset(std::vector<AssembledFrame>& out);

  /// Returns the frame_id of the stream's frame that has begun and not ended.
  std::optional<std::uint64_t> frame_in_flight(Stream stream) const;

  const FrameCounters& counters() const { return counters_; }

 private:
  struct Frame {
    bool is_open = false;
    Leader leader;
    AssembledFrame assembled;
    std::vector<bool> has_row;
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
