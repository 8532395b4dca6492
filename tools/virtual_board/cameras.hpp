// The images that the cameras of a virtual board deliver. Every function throws std::runtime_error
// with what cannot be used.
#pragma once

#include <string>
#include <vector>

#include "sim/gateware/grey_pair.hpp"

namespace fpga_stereo::tools {

/// Reads one pair of image files.
std::vector<sim::GreyPair> read_image_pair(const std::string& left, const std::string& right);

/// Reads the first `max_pairs` pairs, at least one, of FOLDER/left and FOLDER/right, sorted by
/// name, as make_bag extract writes them.
std::vector<sim::GreyPair> read_folder(const std::string& folder, std::size_t max_pairs);

/// Appends a pair. Throws an error that begins with `name` if its size differs from that of the
/// first pair.
void append_pair(std::vector<sim::GreyPair>& pairs, const cv::Mat1b& left, const cv::Mat1b& right,
                 const std::string& name);

}  // namespace fpga_stereo::tools
