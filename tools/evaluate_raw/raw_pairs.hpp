// Raw pairs with their calibration.
#pragma once

#include <string>
#include <vector>

#include "support/euroc.hpp"

namespace fpga_stereo::tools {

struct RawPairs {
  bool is_chessboard = false;  // else a sequence
  StereoCalibration calibration;
  std::vector<FramePaths> frames;  // at least one
};

/// Reads a folder: a sequence of EuRoC if it contains cam0, or chessboards if it contains
/// intrinsics.yml. Throws std::runtime_error with what is missing.
RawPairs read_raw_pairs(const std::string& folder);

}  // namespace fpga_stereo::tools
