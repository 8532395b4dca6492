// Reads folders of the EuRoC MAV dataset (M. Burri et al., IJRR 35, 2016).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "support/stereo_calibration.hpp"

namespace fpga_stereo::tools {

struct FramePaths {
  std::int64_t stamp_ns = 0;
  std::string left, right;  // image files
};

struct EurocFolder {
  StereoCalibration calibration;
  std::vector<FramePaths> frames;  // by ascending stamp, at least one
};

/// Reads a folder with cam0 and cam1, each with sensor.yaml and data/<time in ns>.png. Skips images
/// without a partner and reports them on stderr in the name of `program`. Throws std::runtime_error
/// with the file that cannot be used.
EurocFolder read_euroc_folder(const std::string& folder, const std::string& program);

}  // namespace fpga_stereo::tools
