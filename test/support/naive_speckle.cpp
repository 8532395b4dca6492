#include <cstdlib>

#include "support/naive.hpp"

namespace fpga_stereo::naive {
namespace {

/// Returns the pixels of the region that contains `seed`, by flood fill.
std::vector<cv::Point> region_of(const cv::Mat1w& disparity, int range, cv::Point seed,
                                 cv::Mat1b& seen) {
  std::vector<cv::Point> region{seed};
  seen(seed) = 1;
  for (std::size_t next = 0; next < region.size(); ++next) {
    const cv::Point at = region[next];
    for (const cv::Point step : {cv::Point(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
      const cv::Point to = at + step;
      if (!cv::Rect({}, disparity.size()).contains(to)) continue;
      if (seen(to) != 0 || disparity(to) == kNoDisparity) continue;
      if (std::abs(int{disparity(to)} - int{disparity(at)}) > range) continue;
      seen(to) = 1;
      region.push_back(to);
    }
  }
  return region;
}

}  // namespace

cv::Mat1w speckle(const cv::Mat1w& disparity, const Parameters& p) {
  cv::Mat1w out = disparity.clone();
  if (p.speckle_size == 0) return out;
  for (int y = 0; y < disparity.rows; ++y) {
    // The rows that are known when row y is decided.
    const cv::Mat1w known = disparity.rowRange(0, std::min(disparity.rows, y + 24 + 1));
    cv::Mat1b seen(known.size(), std::uint8_t{0});
    for (int x = 0; x < disparity.cols; ++x) {
      if (known(y, x) == kNoDisparity || seen(y, x) != 0) continue;
      const auto region = region_of(known, 32 * p.speckle_range, {x, y}, seen);
      if (static_cast<int>(region.size()) >= p.speckle_size) continue;
      for (const cv::Point at : region) {
        if (at.y == y) out(at) = kNoDisparity;
      }
    }
  }
  return out;
}

}  // namespace fpga_stereo::naive
