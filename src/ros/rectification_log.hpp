// Logs new rectifications.
#pragma once

#include "core/log_limiter.hpp"
#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {

/// One line of a kind per 10 s: whoever publishes camera_info decides how often there is a new
/// rectification. One thread at a time.
class RectificationLog {
 public:
  /// Logs size, focal length, baseline and mesh deviation of a rectification that is not the last
  /// one. Warns if the principal points differ.
  void note(const StereoRectification& rectification);

 private:
  const StereoRectification* last_ = nullptr;
  LogLimiter limiter_;
};

}  // namespace fpga_stereo
