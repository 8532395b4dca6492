// Finds the names that somebody may have meant.
#pragma once

#include <string>
#include <vector>

namespace fpga_stereo {

/// Returns the `names` that resemble `given`, the nearest first: at most three letters differ, or
/// one contains the other. Ignores case.
std::vector<std::string> similar_names(const std::string& given,
                                       const std::vector<std::string>& names);

}  // namespace fpga_stereo
