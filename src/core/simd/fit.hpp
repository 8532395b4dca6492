// subpixel for semi-global matching: a fit to the census bits around each pixel.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/layout.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::simd {

constexpr int kFitRows = 2 * kFitRadiusY + 1;  // of the window

/// Bytes of pixels, for stages that look at neighbours: winners, and 1 where a pixel is kept. The
/// border holds 0.
struct ByteImage : BorderedImage<std::uint8_t> {
  void create(cv::Size size) { BorderedImage::create(size, kFitRadiusY, 0); }
};

/// Five values per pixel of a row, of the disparities dL - 2 .. dL + 2, with a border.
class FiveRows {
 public:
  void create(int width, int rows);
  /// Returns value k = 0 .. 4 of pixel 0.
  std::uint8_t* row(int row, int k) { return bytes_[5 * row + k] + kBorder; }
  /// Returns the bytes from a value to the next one.
  std::ptrdiff_t pitch() const { return static_cast<std::ptrdiff_t>(bytes_.step[0]); }

 private:
  cv::Mat1b bytes_;
};

/// The SIMD form of fit_subpixel(), a row at a time.
class Fit {
 public:
  /// Prepares the rows from `first_row` down. The images must outlive the use.
  void start(const CensusPlanes& left, const CensusPlanes& right, const ByteImage& winner,
             const ByteImage& kept, const Parameters& p, int first_row);
  /// Computes the next row. `disparity` has kBorder elements behind the row.
  void next(std::uint16_t* disparity);

 private:
  void enter(int y);

  const CensusPlanes *left_ = nullptr, *right_ = nullptr;
  const ByteImage *winner_ = nullptr, *kept_ = nullptr;
  Parameters parameters_;
  int row_ = 0;
  FiveRows distances_;  // of the rows of the window: row y at y % kFitRows
  FiveRows columns_;    // sums along the columns, of one row
  std::vector<std::uint16_t> left_bits_, right_bits_;  // of one row; right has a border
};

// The kernels of Fit. `shift` is a winner minus another; sums include pixels where it is -1 .. 1.

/// Census bits of a row from their planes.
void interleave_planes(const std::uint8_t* plane, std::ptrdiff_t plane_pitch, int width,
                       std::uint16_t* bits);
/// Hamming distances of the five disparities around each winner, 0 where not kept.
void winner_distances(const std::uint16_t* left, const std::uint16_t* right,
                      const std::uint8_t* winner, const std::uint8_t* kept, int width, int range,
                      std::uint8_t* const out[5]);
/// The rows of the window of a pixel.
struct FitColumns {
  int rows = 0;
  const std::uint8_t* winner[kFitRows];
  const std::uint8_t* distances[kFitRows];  // value 0 of each row; the others are `pitch` apart
  std::ptrdiff_t pitch;                     // bytes
};
/// Sums distances along the columns, 0 where not kept.
void sum_columns(const std::uint8_t* winner, const std::uint8_t* kept, int width,
                 const FitColumns& from, std::uint8_t* const columns[5]);
/// Sums of columns -> disparities.
void fit_row(const std::uint8_t* winner, const std::uint8_t* kept, int width, int range,
             const std::uint8_t* const columns[5], std::uint16_t* disparity);
/// Disparities of whole pixels.
void whole_row(const std::uint8_t* winner, const std::uint8_t* kept, int width,
               std::uint16_t* disparity);

}  // namespace fpga_stereo::simd
