// Logs a new rectification.
#pragma once

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {

/// Logs size, focal length, baseline and mesh deviation. Warns if the principal points differ.
void log_rectification(const StereoRectification& rectification);

}  // namespace fpga_stereo
