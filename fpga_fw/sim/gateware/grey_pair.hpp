// The input of a simulated camera pair.
#pragma once

#include <opencv2/core.hpp>

namespace fpga_stereo::sim {

/// Raw left and right image of equal size, 8-bit grey.
struct GreyPair {
  cv::Mat1b left, right;
};

}  // namespace fpga_stereo::sim
