#include "support/chessboard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "support/program.hpp"

namespace fpga_stereo::tools {

cv::Size board_size(const std::string& text) {
  std::smatch match;
  if (std::regex_match(text, match, std::regex("([0-9]{1,3})x([0-9]{1,3})"))) {
    const cv::Size board(std::stoi(match[1]), std::stoi(match[2]));
    if (board.width >= 3 && board.height >= 3) return board;
  }
  throw UsageError(fmt::format("--board = \"{}\": allowed is COLUMNSxROWS, each 3 to 999", text));
}

Corners find_corners(const cv::Mat1b& image, cv::Size board) {
  Corners corners;
  if (!cv::findChessboardCorners(image, board, corners)) return {};
  // Search 11 x 11 px around a corner, or less if that would reach other corners.
  double spacing = cv::norm(corners[1] - corners[0]);
  for (std::size_t i = 2; i < corners.size(); ++i) {
    spacing = std::min(spacing, cv::norm(corners[i] - corners[i - 1]));
  }
  const int radius = std::clamp(static_cast<int>(spacing / 2), 2, 5);
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01);
  cv::cornerSubPix(image, corners, {radius, radius}, {-1, -1}, until);
  return corners;
}

}  // namespace fpga_stereo::tools
