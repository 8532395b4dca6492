// Reads camera pairs from a bag; needs ROS.
#pragma once

#include <string>
#include <vector>

#include "sim/gateware/grey_pair.hpp"

namespace fpga_stereo::tools {

/// Returns the first `max_pairs` pairs of /CAMERA/left/image_raw and /CAMERA/right/image_raw that
/// have equal stamps, at least one. Throws std::runtime_error.
std::vector<sim::GreyPair> read_bag(const std::string& path, const std::string& camera,
                                    std::size_t max_pairs);

}  // namespace fpga_stereo::tools
