#include <opencv2/core.hpp>

#include "core/census_window.hpp"
#include "core/stages.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

std::vector<cv::Point> census_neighbours(const Parameters& p) {
  std::vector<cv::Point> neighbours;
  if (p.stereo_algorithm == StereoAlgorithm::kSgm) {
    for (const int distance : {1, kSgmCensusDistance}) {
      for (int dy = -distance; dy <= distance; dy += distance) {
        for (int dx = -distance; dx <= distance; dx += distance) {
          if (dx != 0 || dy != 0) neighbours.emplace_back(dx, dy);
        }
      }
    }
    return neighbours;
  }
  const int radius = p.census_window_size / 2;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      const bool centre = dx == 0 && dy == 0;
      const bool in_pattern =
          p.census_pattern == CensusPattern::kFull || (dx % 2 == 0 && dy % 2 == 0);
      if (!centre && in_pattern) neighbours.emplace_back(dx, dy);
    }
  }
  return neighbours;
}

void census(const cv::Mat1b& image, const Parameters& p, cv::Range rows, cv::Mat& bits) {
  const std::vector<cv::Point> neighbours = census_neighbours(p);
  const int words = (static_cast<int>(neighbours.size()) + 31) / 32;
  bits.create(image.size(), CV_32SC(words));
  if (rows == cv::Range::all()) rows = {0, image.rows};

  for (int y = rows.start; y < rows.end; ++y) {
    const std::uint8_t* centre = image[y];
    auto* out = bits.ptr<std::uint32_t>(y);
    std::fill(out, out + static_cast<std::ptrdiff_t>(image.cols) * words, 0U);
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      const auto [dx, dy] = std::pair(neighbours[k].x, neighbours[k].y);
      if (y + dy < 0 || y + dy >= image.rows) continue;  // outside: bit 0
      const std::uint8_t* neighbour = image[y + dy];
      const int first = std::max(0, -dx);
      const int last = std::min(image.cols, image.cols - dx);
      for (int x = first; x < last; ++x) {
        const std::uint32_t bit = neighbour[x + dx] < centre[x] ? 1 : 0;
        out[x * words + static_cast<int>(k / 32)] |= bit << (k % 32);
      }
    }
  }
}

}  // namespace fpga_stereo
