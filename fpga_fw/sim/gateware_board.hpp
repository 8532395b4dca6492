// A board whose gateware is the simulated one, link included.
#pragma once

#include "sim/board.hpp"
#include "sim/system.hpp"

namespace fpga_stereo::sim {

/// Its time is that of its clock: a simulation that is slower than ClockHz lags behind.
class GatewareBoard : public Board {
 public:
  explicit GatewareBoard(SystemModel model) : model_(std::move(model)) {}

  void reset() override;
  std::size_t from_host(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t to_host(std::uint8_t* bytes, std::size_t size) override;
  /// A pair that comes before the last one has gone in is not seen.
  void feed(const RawPair& pair) override;
  void run(std::chrono::microseconds time) override;

 private:
  SystemModel model_;
  double clocks_due_ = 0;
};

}  // namespace fpga_stereo::sim
