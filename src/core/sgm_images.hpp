// The smoothed images that semi-global matching compares, besides the census bits.
#pragma once

#include <opencv2/core.hpp>

namespace fpga_stereo {

/// A of pipeline.md: [1 2 1] / 4 along each row, rounded half up. Borders are replicated.
void smooth_rows(const cv::Mat1b& image, cv::Range rows, cv::Mat1b& smooth);

/// G of pipeline.md: the 5 x 5 binomial [1 4 6 4 1] squared / 256, rounded half up. Borders are
/// replicated.
void smooth_binomial(const cv::Mat1b& image, cv::Range rows, cv::Mat1b& smooth);

}  // namespace fpga_stereo
