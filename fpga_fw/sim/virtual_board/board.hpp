// A board as what stands at the other end of a line: bytes, cameras, time. One is the software
// pipeline behind the packets, another the simulated gateware.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "sim/gateware/grey_pair.hpp"

namespace fpga_stereo::sim {

class Board {
 public:
  virtual ~Board() = default;

  /// As after power-on. Bytes that wait are lost.
  virtual void reset() = 0;
  /// Bytes of the host. How many were taken: a board that is busy holds the line up.
  virtual std::size_t receive(const std::uint8_t* bytes, std::size_t size) = 0;
  /// Takes bytes for the host: how many.
  virtual std::size_t transmit(std::uint8_t* bytes, std::size_t size) = 0;
  /// The cameras deliver a pair. It is dropped where the board takes its images from the host.
  virtual void feed(const GreyPair& pair) = 0;
  /// Time passes.
  virtual void run(std::chrono::microseconds time) = 0;
};

}  // namespace fpga_stereo::sim
