// Measures how long stages take.
#pragma once

#include <chrono>
#include <utility>

#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo::simd {

/// Adds the wall-clock time between laps to the times of stages.
class StageTimer {
 public:
  /// `ms` must outlive the timer. A disabled timer reads no clock and adds nothing.
  explicit StageTimer(StageTimes& ms, bool is_enabled = true) : ms_(ms), is_enabled_(is_enabled) {
    restart();
  }
  /// Adds the time since the last lap to `stage`.
  void lap(Stage stage) {
    if (is_enabled_) ms_[static_cast<std::size_t>(stage)] += restart();
  }
  /// Starts the next lap and returns the time since the last one in ms.
  double restart() {
    if (!is_enabled_) return 0;
    const Clock::time_point last = std::exchange(start_, Clock::now());
    return std::chrono::duration<double, std::milli>(start_ - last).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  StageTimes& ms_;
  const bool is_enabled_;
  Clock::time_point start_;
};

}  // namespace fpga_stereo::simd
