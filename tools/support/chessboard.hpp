// Finds the corners of a chessboard.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

using Corners = std::vector<cv::Point2f>;

/// Parses the --board "9x6", the number of inner corners. Throws UsageError.
cv::Size board_size(const std::string& text);

/// Returns the inner corners, row by row; empty if the image does not show the whole chessboard.
Corners find_corners(const cv::Mat1b& image, cv::Size board);

}  // namespace fpga_stereo::tools
