// The neighbours that the census transform compares with the centre of its window.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo {

/// Offsets from the centre in raster order; their number is the number of census bits.
std::vector<cv::Point> census_neighbours(const Parameters& parameters);

}  // namespace fpga_stereo
