// What is on the FPGA's side of a virtual FT232H: a test or a virtual board.
#pragma once

#include <cstddef>
#include <cstdint>

namespace fpga_stereo::sim {

/// The connection that carries the chip calls both functions, each from one thread at a time, and
/// may call them at the same time.
class FifoBackend {
 public:
  virtual ~FifoBackend() = default;
  /// Takes bytes from the host. Returns how many it took; the chip offers the rest again after
  /// poke().
  virtual std::size_t receive(const std::uint8_t* bytes, std::size_t size) = 0;
  /// Writes up to `size` bytes for the host to `bytes`. Returns how many it wrote. After returning
  /// 0, call poke() when there are bytes.
  virtual std::size_t transmit(std::uint8_t* bytes, std::size_t size) = 0;
};

}  // namespace fpga_stereo::sim
