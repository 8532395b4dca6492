// From the byte stream of a link to packets. FTDI FIFOs and serial lines lose, double and shift
// bytes: nothing but a packet whose two CRCs are right comes out, and after any damage the next
// intact packet does.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "link/packet.hpp"

namespace fpga_stereo::link {

/// An intact packet; the payload is the decoder's, up to its next call.
struct Packet {
  Header header;
  const std::uint8_t* payload = nullptr;  // header.length bytes
};

class Decoder {
 public:
  /// Adds bytes as they came, split anywhere. Copies them once. Take all packets out before more
  /// are given: what is left stays in memory.
  void push(const std::uint8_t* bytes, std::size_t size);

  /// The next intact packet; none if more bytes are needed.
  std::optional<Packet> next();

  /// The link has fallen silent: what looks like a packet that lacks its end is none. The scan goes
  /// on behind its sync word; call next() again.
  void discard_partial_packet();

  /// Another stream begins: what waits is forgotten, and any sequence number is the first. The
  /// counters go on.
  void reset();

  const DecoderCounters& counters() const { return counters_; }

 private:
  std::size_t left() const { return bytes_.size() - at_; }
  void skip(std::size_t bytes);
  /// Moves to the next sync word or to the first bytes of one at the end; false: no whole header.
  bool find_sync();
  void count_lost(std::uint32_t sequence);

  std::vector<std::uint8_t> bytes_;
  std::size_t at_ = 0;                     // first byte that is not yet decided upon
  std::optional<std::uint32_t> expected_;  // sequence number of the next packet
  DecoderCounters counters_;
};

}  // namespace fpga_stereo::link
