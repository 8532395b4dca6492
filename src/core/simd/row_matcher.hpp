// match and select for a band of rows: everything that a row needs lies close together, and nothing
// is kept but running sums.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/kernels.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::simd {

/// The census bits of an image: byte planes, row by row.
struct CensusPlanes {
  cv::Mat1b bytes;  // H x row bytes
  int planes = 0;
  std::ptrdiff_t pitch = 0;  // bytes from plane to plane
  std::ptrdiff_t first = 0;  // of pixel 0, in a plane

  void create(cv::Size size, int planes, int padded);
  std::uint8_t* row(int y) { return bytes[y] + first; }
  const std::uint8_t* row(int y) const { return bytes[y] + first; }
};

class RowMatcher {
 public:
  /// The images must outlive the use; next() then gives row `first_row` and those below.
  void start(const CensusPlanes& left, const CensusPlanes& right, int width, const Parameters& p,
             int census_bits, int first_row);
  /// The next row, valid until the next call. With `select_ms` it says how much of the time that
  /// took was select's.
  const SelectedRow& next(double* select_ms = nullptr);

 private:
  void enter(int y, int end);
  void begin_sums();
  int select_columns(int x0, int x1, int next_right);

  const CensusPlanes *left_ = nullptr, *right_ = nullptr;
  int width_ = 0, height_ = 0, range_ = 0, padded_ = 0, half_ = 0, radius_ = 0, window_ = 0;
  int row_ = 0;      // that comes next
  int entered_ = 0;  // columns of the row that enters the window
  cv::Mat1b slots_;  // Hamming distances: a row of the window each, W x padded
  cv::Mat1s columns_;
  std::int16_t* column_ = nullptr;  // of pixel 0
  cv::Mat1w ring_;
  SumRing sums_{};
  cv::Mat1w words_;
  cv::Mat1b bytes_;
  SelectedRow selected_{};
};

}  // namespace fpga_stereo::simd
