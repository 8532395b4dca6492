// The kernels of select.
#pragma once

#include <cstdint>

#include "core/simd/layout.hpp"

namespace fpga_stereo::simd {

/// Selects for the left pixels of a block. Writes whole multiples of 8 pixels.
void select_left(const WindowSums& sums, const SelectionRow& out);
/// Selects for the right pixels x0 .. x0 + kLaneGroup - 1, whose left partners `sums` must still
/// have. Pixels behind the row get values without meaning.
void select_right(const WindowSums& sums, int x0, std::uint8_t* right_winner);

}  // namespace fpga_stereo::simd
