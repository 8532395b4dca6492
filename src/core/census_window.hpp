// The neighbours that the census transform compares with the centre of its window.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo {

/// Returns the offsets from the centre in the order of the census bits, one per bit.
std::vector<cv::Point> census_neighbours(const Parameters& parameters);

}  // namespace fpga_stereo
