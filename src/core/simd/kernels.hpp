// The stages as SIMD kernels: a row, or some columns of one, at a time. Each gives the bits of its
// scalar twin in stages.hpp, on every target.
//
// match and select keep the disparities of a pixel side by side, the largest first: lane i is
// disparity padded - 1 - i. The right pixels that a left pixel meets then lie in raster order, and
// a window sum moves along the row with two additions for all disparities.
#pragma once

#include <cstddef>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/source_table.hpp"
#include "fpga_stereo/core/mesh.hpp"

namespace fpga_stereo::simd {

constexpr int kLaneGroup = 32;  // disparities come in groups of so many
constexpr int kBorder = 64;     // bytes around a row that kernels may read, and write behind it

/// disparity_range, rounded up to whole groups.
constexpr int padded_range(int range) { return (range + kLaneGroup - 1) / kLaneGroup * kLaneGroup; }

/// Rectifies row `y` of the mesh. raw is 8UC1 or 8UC3, `out` has room for the row alone.
void rectify_row(const cv::Mat& raw, const Mesh& mesh, int y, std::uint8_t* out);
/// Rectifies `count` cells of a row, 8 pixels each; how many were left out, their offset being < 0.
int rectify_cells(const cv::Mat1b& raw, const SourceCell* cells, int count, std::uint8_t* out);

/// Bit k % 8 of byte x of plane k / 8 says whether the pixel at `neighbours[k]` bytes from pixel x
/// is smaller. The image has a border of 255 that no pixel is larger than.
void census_row(const std::uint8_t* image, int width, const std::vector<std::ptrdiff_t>& neighbours,
                std::uint8_t* planes, std::ptrdiff_t plane_pitch);

/// A row of census bits that enters the correlation window.
struct HammingRow {
  const std::uint8_t *left, *right;  // plane 0, pixel 0; there are `padded` bytes before right
  std::ptrdiff_t plane_pitch;
  int planes;
  int range, padded;  // disparities
  int half;           // of the census bits: chance
};
/// Hamming distances of the columns x0 .. x1 - 1 in the place of `slot`'s; what that adds to the
/// columns' sums is added. slot and columns: `padded` lanes per pixel, from pixel 0.
void hamming(const HammingRow& row, int x0, int x1, std::uint8_t* slot, std::int16_t* columns);
/// The same for a row below the image: the distances become 0.
void leave(int padded, int x0, int x1, std::uint8_t* slot, std::int16_t* columns);

/// Window sums of some columns of a row, in a ring: those of pixel x stand at row x & mask.
struct SumRing {
  std::uint16_t* first;  // lane 0 of row 0; around each row kLaneGroup lanes of 0xFFFF
  std::ptrdiff_t pitch;  // lanes from row to row
  int mask;
  int range, padded;

  std::uint16_t* row(int x) const { return first + (x & mask) * pitch; }
};
/// S(x) = S(x - 1) + columns(x + radius) - columns(x - radius - 1) for x0 .. x1 - 1, whose rows of
/// the ring follow one another.
void box(const std::int16_t* columns, int radius, int x0, int x1, const SumRing& sums);

/// What select knows of a row, by pixel; kBorder bytes behind each, and before right_winner as many
/// as there are disparities.
struct SelectedRow {
  std::uint8_t *winner, *right_winner;
  std::uint16_t *winner_sum, *runner_up_sum;
  std::uint16_t* around[5];
};
/// Winner, its sum, rival and neighbours of the columns x0 .. x1 - 1, x0 a multiple of 8.
void select_left(const SumRing& sums, int x0, int x1, const SelectedRow& out);
/// Right winners of the pixels x0 .. x0 + kLaneGroup - 1, of which those up to width - 1 exist.
void select_right(const SumRing& sums, int x0, int width, std::uint8_t* right_winner);

void check_row(const SelectedRow& s, int width, bool left_right, int most_difference,
               bool uniqueness, int factor, std::uint8_t* kept);
void subpixel_row(const SelectedRow& s, const std::uint8_t* kept, int width, int range, bool refine,
                  std::uint16_t* disparity);

/// What speckle sees of a row, a bit per pixel: bit x % 64 of word x / 64. Behind the row: 0.
struct ConnectedRow {
  std::uint64_t *valid, *left, *up;  // has a disparity; is connected with its neighbour there
};
/// One pixel is read before the row.
void connect_row(const std::uint16_t* row, const std::uint16_t* above, int width, int range,
                 const ConnectedRow& out);

}  // namespace fpga_stereo::simd
