// select for semi-global matching, whose sums have eight bits.
#pragma once

#include "core/simd/aggregate.hpp"

namespace fpga_stereo::simd {

/// Winners, sums of winners and runners-up of a row of left pixels.
void select_left_pixels(const PathSums& sums, const SelectionRow& out);
/// Winners of a row of right pixels.
void select_right_pixels(const PathSums& sums, std::uint8_t* right_winner);

}  // namespace fpga_stereo::simd
