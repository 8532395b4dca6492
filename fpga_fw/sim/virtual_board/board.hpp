// The interface of a virtual board: bytes from and to the host, camera images, and time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "sim/gateware/grey_pair.hpp"

namespace fpga_stereo::sim {

class Board {
 public:
  virtual ~Board() = default;

  /// Returns to the state after power-on. Discards all bytes in both directions.
  virtual void reset() = 0;
  /// Takes bytes from the host. Returns how many it took: a busy board takes fewer than `size`.
  virtual std::size_t receive(const std::uint8_t* bytes, std::size_t size) = 0;
  /// Writes up to `size` bytes for the host to `bytes`. Returns how many it wrote.
  virtual std::size_t transmit(std::uint8_t* bytes, std::size_t size) = 0;
  /// Delivers a pair from the cameras. The board drops it while its input is the host.
  virtual void feed(const GreyPair& pair) = 0;
  /// Advances the board's time.
  virtual void run(std::chrono::microseconds time) = 0;
};

}  // namespace fpga_stereo::sim
