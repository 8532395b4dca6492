// The clock of timeouts and of the times at which bytes arrive. It never goes back.
#pragma once

#include <chrono>

namespace fpga_stereo::link {

using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;

}  // namespace fpga_stereo::link
