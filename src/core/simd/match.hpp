// match: window sums of Hamming distances, a block of columns at a time.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "core/simd/layout.hpp"

namespace fpga_stereo::simd {

/// Census bits -> window sums S(x, y, d) from running sums. The SIMD form of fpga_stereo::Match.
class Match {
 public:
  /// Prepares the rows from `first_row` down. The census bits must outlive the use.
  void start(const CensusPlanes& left, const CensusPlanes& right, const Parameters& p,
             int first_row);
  /// Returns the sums of the next block of columns, in raster order; blocks end at the end of a
  /// row. Valid until the next call.
  const WindowSums& next();

 private:
  void enter(int y, int begin, int end);
  void start_sums();

  const CensusPlanes *left_ = nullptr, *right_ = nullptr;
  int radius_ = 0, window_ = 0;     // of the correlation window, px
  int row_ = 0, x_ = 0;             // where the next block begins
  cv::Mat1b distances_;             // Hamming distances: a row per row of the window, W x lanes
  cv::Mat1s columns_;               // column sums, W x lanes, with columns of zeros on both sides
  std::int16_t* column_ = nullptr;  // sum of column 0
  cv::Mat1w ring_;
  WindowSums sums_{};
};

// The kernels of Match.

/// Where to compute the Hamming distances of a row that enters the correlation window.
struct HammingRow {
  const std::uint8_t *left, *right;  // plane 0, pixel 0
  std::ptrdiff_t plane_pitch;        // bytes
  int planes;
  int range, lanes;  // disparities; lanes per pixel
  int half;          // of the census bits: the distance to a pixel outside the right image
};
/// Replaces the Hamming distances of columns `begin` .. `end` - 1 and adds the change to their
/// column sums. Both arrays begin at column 0, with row.lanes lanes per column.
void hamming_distances(const HammingRow& row, int begin, int end, std::uint8_t* distances,
                       std::int16_t* columns);
/// Does the same for a row below the image, where all distances are 0.
void clear_distances(int lanes, int begin, int end, std::uint8_t* distances, std::int16_t* columns);

/// S(x) = S(x - 1) + columns(x + radius) - columns(x - radius - 1) for the columns of a block.
void window_sums(const std::int16_t* columns, int radius, const WindowSums& sums);

}  // namespace fpga_stereo::simd
