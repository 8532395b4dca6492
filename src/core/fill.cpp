#include <algorithm>
#include <opencv2/core.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {

void fill(cv::Range rows, cv::Mat1w& disparity) {
  // kNoDisparity is the largest value, so min() prefers a disparity.
  static_assert(kNoDisparity == 0xFFFF);
  if (rows == cv::Range::all()) rows = {0, disparity.rows};
  const int width = disparity.cols;
  std::vector<std::uint16_t> nearest_left(width);
  for (int y = rows.start; y < rows.end; ++y) {
    std::uint16_t* row = disparity[y];
    std::uint16_t nearest = kNoDisparity;
    for (int x = 0; x < width; ++x) {
      if (row[x] != kNoDisparity) nearest = row[x];
      nearest_left[x] = nearest;
    }
    nearest = kNoDisparity;
    for (int x = width - 1; x >= 0; --x) {
      if (row[x] != kNoDisparity) nearest = row[x];
      row[x] = std::min(nearest_left[x], nearest);
    }
  }
}

}  // namespace fpga_stereo
