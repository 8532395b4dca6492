// The memory layouts that the SIMD stages pass to each other.
//
// Stages that compare disparities keep those of a pixel side by side, the largest first: lane i
// holds disparity `lanes - 1 - i`. The right pixels that a left pixel is compared with then lie in
// raster order, and a window sum moves along the row with one addition and one subtraction per
// disparity.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>

#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::simd {

constexpr int kLaneGroup = 32;     // lanes per pixel are a multiple of this
constexpr int kBlockColumns = 32;  // columns that match and select process at a time, in L1
/// Elements around a row. Stages may read the border on both sides and write the one on the right.
constexpr int kBorder = 64;

/// Returns disparity_range rounded up to whole lane groups.
constexpr int lanes_per_pixel(int disparity_range) {
  return (disparity_range + kLaneGroup - 1) / kLaneGroup * kLaneGroup;
}

/// Returns the largest radius of a census window that the parameter table allows, in px.
int max_census_radius();

/// An image inside a larger one: kBorder columns on each side, `border_rows` rows above and below.
template <class T>
struct BorderedImage {
  cv::Mat_<T> all, image;

  /// Fills the image and its border with `fill` when the size changes.
  void create(cv::Size size, int border_rows, T fill) {
    if (image.size() == size) return;
    all.create(size.height + 2 * border_rows, size.width + 2 * kBorder);
    all = fill;
    image = all(cv::Rect({kBorder, border_rows}, size));
  }
};

/// An image for census. Its border of 255 is never darker than a pixel, so neighbours outside the
/// image give 0.
struct CensusImage : BorderedImage<std::uint8_t> {
  void create(cv::Size size) { BorderedImage::create(size, max_census_radius(), 255); }
};

/// A disparity image. Its border holds kNoDisparity, which speckle reads to the left of each row.
struct DisparityImage : BorderedImage<std::uint16_t> {
  void create(cv::Size size);
};

/// The smoothed left image, whose edges set the penalties of semi-global matching.
struct GuideImage : BorderedImage<std::uint8_t> {
  void create(cv::Size size) { BorderedImage::create(size, 0, 0); }
};

/// Census bits of an image in byte planes, row by row: bit k % 8 of byte x of plane k / 8 belongs
/// to neighbour k of pixel x. For semi-global matching, one more plane has the grey values,
/// smoothed along the row.
struct CensusPlanes {
  int width = 0, height = 0;  // px
  int bits = 0;               // per pixel
  int count = 0;              // planes of bits
  std::ptrdiff_t pitch = 0;   // bytes from plane to plane of a row

  void create(cv::Size size, const Parameters& p);
  /// Returns pixel 0 of plane 0. Up to lanes_per_pixel() bytes before each plane may be read.
  std::uint8_t* row(int y) { return bytes_[y] + margin_; }
  const std::uint8_t* row(int y) const { return bytes_[y] + margin_; }
  /// Returns pixel 0 of the grey values.
  std::uint8_t* grey(int y) { return row(y) + count * pitch; }

 private:
  int margin_ = 0;  // bytes before a plane
  cv::Mat1b bytes_;
};

/// Window sums of a block of columns, which match computes and select reads. They are stored in a
/// ring with a row per column, which still holds at least disparity_range columns before the block.
struct WindowSums {
  std::uint16_t* ring;   // row 0; kLaneGroup lanes of 0xFFFF surround each row
  std::ptrdiff_t pitch;  // lanes from row to row
  int mask;              // rows of the ring - 1; column x is in row x & mask
  int range, lanes;      // disparities; lanes per pixel, 0xFFFF where there is no disparity
  int width;             // px of the image row
  int begin, end;        // columns of this block

  std::uint16_t* column(int x) const { return ring + (x & mask) * pitch; }
};

/// The results of select for a row, indexed by pixel: a view of a SelectionBuffer. The SIMD form of
/// a row of Selection.
struct SelectionRow {
  int width;
  std::uint8_t *winner, *right_winner;
  std::uint16_t *winner_sum, *runner_up_sum;
  std::uint16_t* around[5];  // S(dL-2) .. S(dL+2); undefined outside the search range
};

/// Owns the arrays of a SelectionRow. Each has kBorder elements behind the row; winner and
/// right_winner also have lanes_per_pixel() elements before it.
class SelectionBuffer {
 public:
  /// Sets everything to 0.
  void create(int width, int disparity_range);
  const SelectionRow& row() const { return row_; }

 private:
  cv::Mat1b bytes_;
  cv::Mat1w words_;
  SelectionRow row_{};
};

}  // namespace fpga_stereo::simd
