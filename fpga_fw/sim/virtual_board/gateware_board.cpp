#include "sim/virtual_board/gateware_board.hpp"

#include <algorithm>

namespace fpga_stereo::sim {
namespace {

constexpr double kMaxRun = 0.02;                // s of the clock per call: callers hold locks
constexpr std::size_t kMaxPendingBytes = 4096;  // from the host

}  // namespace

void GatewareBoard::reset() { model_.reset(); }

std::size_t GatewareBoard::receive(const std::uint8_t* bytes, std::size_t size) {
  const std::size_t pending = model_.bytes_left();
  const std::size_t taken = std::min(size, kMaxPendingBytes - std::min(pending, kMaxPendingBytes));
  model_.receive(bytes, taken);
  return taken;
}

std::size_t GatewareBoard::transmit(std::uint8_t* bytes, std::size_t size) {
  return model_.transmit(bytes, size);
}

void GatewareBoard::feed(const GreyPair& pair) {
  if (model_.pixels_left() == 0) model_.feed(pair);
}

void GatewareBoard::run(std::chrono::microseconds time) {
  const double per_us = model_.parameters().clock_hz * 1e-6;
  const double max_due = kMaxRun * model_.parameters().clock_hz;
  clocks_due_ = std::min(clocks_due_ + static_cast<double>(time.count()) * per_us, max_due);
  while (clocks_due_ >= 1) {
    const std::int64_t before = model_.clocks();
    model_.run(static_cast<std::int64_t>(clocks_due_));
    clocks_due_ -= static_cast<double>(model_.clocks() - before);
  }
}

}  // namespace fpga_stereo::sim
