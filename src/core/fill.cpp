#include <algorithm>
#include <opencv2/core.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {

void fill(cv::Range rows, cv::Mat1w& disparity) {
  // kNoDisparity is the largest value, so min() prefers a disparity.
  static_assert(kNoDisparity == 0xFFFF);
  if (rows == cv::Range::all()) rows = {0, disparity.rows};
  for (int y = rows.start; y < rows.end; ++y) {
    std::uint16_t *const begin = disparity[y], *const end = begin + disparity.cols;
    std::uint16_t left = kNoDisparity;
    for (std::uint16_t* gap = std::find(begin, end, kNoDisparity); gap != end;) {
      if (gap != begin) left = gap[-1];
      std::uint16_t* const gap_end =
          std::find_if(gap, end, [](std::uint16_t d) { return d != kNoDisparity; });
      const std::uint16_t right = gap_end == end ? kNoDisparity : *gap_end;
      std::fill(gap, gap_end, std::min(left, right));
      gap = std::find(gap_end, end, kNoDisparity);
    }
  }
}

}  // namespace fpga_stereo
