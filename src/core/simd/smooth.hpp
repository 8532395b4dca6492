// The smoothed images of semi-global matching (core/sgm_images.hpp).
#pragma once

#include "core/simd/layout.hpp"

namespace fpga_stereo::simd {

/// A of pipeline.md, into the grey plane of `planes`.
void smooth_rows(const CensusImage& image, cv::Range rows, CensusPlanes& planes);

/// G of pipeline.md. `guide` must have been created.
void smooth_binomial(const CensusImage& image, cv::Range rows, GuideImage& guide);

}  // namespace fpga_stereo::simd
