// What the cameras of a virtual board see.
#pragma once

#include <string>
#include <vector>

#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::tools {

/// Pairs of one size, at least one, at most `most` (the first ones). Each throws
/// std::runtime_error that names what cannot be used.
std::vector<sim::GreyPair> read_image_pair(const std::string& left, const std::string& right);
/// FOLDER/left and FOLDER/right, both sorted by name: as make_bag extract writes them.
std::vector<sim::GreyPair> read_folder(const std::string& folder, std::size_t most);
/// /CAMERA/left and right image_raw, paired by stamp.
std::vector<sim::GreyPair> read_bag(const std::string& path, const std::string& camera,
                                    std::size_t most);

}  // namespace fpga_stereo::tools
