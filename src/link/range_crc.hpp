// The CRC of any range of a byte stream, each byte processed once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace fpga_stereo::link {

/// Keeps the CRC register after each byte, so that the CRC of a range is the difference of two
/// registers, and ranges may overlap at no cost. Positions count from the first byte of the
/// caller's buffer.
class RangeCrc {
 public:
  /// Returns the CRC-32C of bytes [begin, end), as crc32c() does. `end` - `begin` must be a
  /// multiple of 4 and at most 4 + kMaxPayloadBytes. Fast if `begin` does not decrease from call to
  /// call.
  std::uint32_t of(const std::uint8_t* bytes, std::size_t begin, std::size_t end);
  /// Notes that the caller has removed the first `size` bytes of the buffer.
  void remove(std::size_t size);
  void clear();

 private:
  std::vector<std::uint32_t> registers_;  // after the bytes before first_, first_ + 1, ...
  std::size_t first_ = 0;
};

}  // namespace fpga_stereo::link
