// median: the two medians of dense disparities.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "core/simd/layout.hpp"

namespace fpga_stereo::simd {

/// The SIMD form of fpga_stereo::masked_median(). `left` is the rectified image. Both write up to
/// kBorder elements behind each row of `out`.
void masked_median(const CensusImage& left, const DisparityImage& in, const Parameters& p,
                   cv::Range rows, DisparityImage& out);

/// Replicates the outermost columns into the border, which median() reads.
void replicate_columns(DisparityImage& image, cv::Range rows);
/// The SIMD form of fpga_stereo::median().
void median(const DisparityImage& in, cv::Range rows, DisparityImage& out);

/// What a row of the first median looks at: rows -4, -2, 0, 2, 4, null outside the image.
struct MedianRows {
  const std::uint8_t* greys[5];
  const std::uint16_t* disparities[5];
  int width, max_difference;
};

}  // namespace fpga_stereo::simd
