// The host's time of day beside its steady clock.
#pragma once

#include <cmath>
#include <cstdint>

#include "link/clock.hpp"

namespace fpga_stereo::link {

/// Converts times of the steady clock to the time of day, and notices when that is set.
class HostClock {
 public:
  static constexpr double kMinStep = 0.01;  // s: more between two readings is not slewing

  /// Notes that at `now` it was `wall`, s since 1970. Returns by how much the time of day was set
  /// since the last reading, s; 0 if it was not.
  double read(Time now, double wall) {
    const double offset = wall - seconds(now);
    const double step = has_offset_ ? offset - offset_ : 0;
    offset_ = offset;
    has_offset_ = true;
    if (std::abs(step) < kMinStep) return 0;
    ++steps_;
    return step;
  }
  /// Returns the time of day, s, at a time of the steady clock, s.
  double wall(double steady) const { return offset_ + steady; }
  /// Returns how often the time of day was set.
  std::uint64_t steps() const { return steps_; }

 private:
  double offset_ = 0;
  bool has_offset_ = false;
  std::uint64_t steps_ = 0;
};

}  // namespace fpga_stereo::link
