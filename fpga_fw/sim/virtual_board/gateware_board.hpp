// A board whose gateware is the simulated one, link included.
#pragma once

#include "sim/gateware/system.hpp"
#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

/// Its time is that of its clock: a simulation that is slower than ClockHz lags behind.
class GatewareBoard : public Board {
 public:
  explicit GatewareBoard(SystemModel model) : model_(std::move(model)) {}

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  /// A pair that comes before the last one has gone in is not seen.
  void feed(const GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

 private:
  SystemModel model_;
  double clocks_due_ = 0;
};

}  // namespace fpga_stereo::sim
