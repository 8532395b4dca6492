// A virtual board that computes with the simulated gateware, including its end of the link.
#pragma once

#include "sim/gateware/system.hpp"
#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

/// Its time is that of its clock: if the simulation is slower than ClockHz, the time lags behind.
class GatewareBoard : public Board {
 public:
  explicit GatewareBoard(SystemModel model) : model_(std::move(model)) {}

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  /// Ignores the pair if the previous one has not been read completely.
  void feed(const GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

 private:
  SystemModel model_;
  double clocks_due_ = 0;
};

}  // namespace fpga_stereo::sim
