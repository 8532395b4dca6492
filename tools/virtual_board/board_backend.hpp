// A virtual board on the FPGA's side of a virtual FT232H.
#pragma once

#include "sim/ft232h/fifo_backend.hpp"
#include "sim/virtual_board/faulty_board.hpp"

namespace fpga_stereo::tools {

class BoardBackend : public sim::FifoBackend {
 public:
  explicit BoardBackend(sim::FaultyBoard& board) : board_(board) {}

  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override {
    return board_.receive(bytes, size);
  }
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override {
    return board_.transmit(bytes, size);
  }

 private:
  sim::FaultyBoard& board_;
};

}  // namespace fpga_stereo::tools
