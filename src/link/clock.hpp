// The clock of timeouts and of the times at which bytes arrive. It never goes back, unlike the time
// of day, which becomes part of a stamp only at the end.
#pragma once

#include <chrono>

namespace fpga_stereo::link {

using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;

/// Returns the seconds since the clock's epoch.
inline double seconds(Time time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

}  // namespace fpga_stereo::link
