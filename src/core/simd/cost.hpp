// cost: matching costs of a row, for semi-global matching.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "core/simd/layout.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::simd {

/// Census bits and smoothed grey values -> matching costs. The SIMD form of fpga_stereo::Cost.
class Cost {
 public:
  /// Prepares the rows from `first_row` down. The planes must outlive the use.
  void start(const CensusPlanes& left, const CensusPlanes& right, const Parameters& p,
             int first_row);
  /// Writes C of the next row: W x lanes_per_pixel, kNoCost in lanes without a disparity.
  void next(std::uint8_t* costs);

 private:
  std::uint8_t* slot(int y) { return pixel_costs_[(y + 3) % 3]; }

  const CensusPlanes *left_ = nullptr, *right_ = nullptr;
  Parameters parameters_;
  int lanes_ = 0, row_ = 0;
  cv::Mat1b pixel_costs_;  // of three rows, W x lanes each
};

constexpr std::uint8_t kNoCost = 0x80;  // larger than every cost of a path

// The kernels of Cost.

/// What the costs of a row are computed from.
struct CostRow {
  const std::uint8_t *left, *right;  // plane 0, pixel 0; right may be read lanes - 1 bytes before
  std::ptrdiff_t plane_pitch;        // bytes
  int width, range, lanes;
  int difference_limit, difference_shift, outside, shift;
};
/// Computes p(x, y, d) of a row.
void pixel_costs(const CostRow& row, std::uint8_t* out);
/// Sums p of three rows to matching costs.
void matching_costs(const CostRow& row, const std::uint8_t* above, const std::uint8_t* here,
                    const std::uint8_t* below, std::uint8_t* costs);

}  // namespace fpga_stereo::simd
