// Finds packets in the byte stream of a link. FTDI FIFOs and serial lines lose, repeat and shift
// bytes: the decoder returns only packets whose two CRCs are right, and finds the next intact
// packet after any damage.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "link/packet.hpp"
#include "link/range_crc.hpp"

namespace fpga_stereo::link {

/// An intact packet. The decoder owns the payload; it is valid until the decoder's next call.
struct Packet {
  Header header;
  const std::uint8_t* payload = nullptr;  // header.length bytes
};

class Decoder {
 public:
  /// Adds received bytes, split anywhere; copies them. Call next() until it returns nothing before
  /// adding more: the bytes of packets not taken stay in memory.
  void push(const std::uint8_t* bytes, std::size_t size);

  /// Returns the next intact packet; nullopt if more bytes are needed.
  std::optional<Packet> next();

  /// After a silence, discards the partial packet at the end. next() then searches its bytes again,
  /// from the byte after its sync word.
  void discard_partial_packet();

  /// Starts with a new byte stream: drops the bytes and accepts any sequence number. The counters
  /// continue.
  void reset();

  const DecoderCounters& counters() const { return counters_; }

 private:
  std::size_t left() const { return bytes_.size() - at_; }
  void skip(std::size_t bytes);
  /// Skips to the next sync word, or to the start of one at the end of the bytes. Returns true if a
  /// whole header follows.
  bool find_sync();
  /// Checks the payload of the packet at at_.
  bool is_intact(const Header& header);
  void count_lost(std::uint32_t sequence);

  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;  // first byte that was not searched
  // Damaged packets are searched again, and packets in them may overlap: a device could make every
  // byte count a thousand times. Up to here, CRCs come from damaged_crc_, which counts it once.
  std::size_t damaged_end_ = 0;
  RangeCrc damaged_crc_;
  std::optional<std::uint32_t> expected_;  // sequence number of the next packet
  DecoderCounters counters_;
};

}  // namespace fpga_stereo::link
