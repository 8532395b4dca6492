// speckle: finds regions from runs of connected pixels; a row has far fewer runs than pixels.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/layout.hpp"

namespace fpga_stereo::simd {

/// The speckle filter. Keeps its memory from frame to frame.
class SpeckleFilter {
 public:
  /// Sets small regions of `disparity` to kNoDisparity, in place. The SIMD form of speckle().
  void apply(const Parameters& p, DisparityImage& disparity);

 private:
  /// Bits of a row, pixel x in bit x % 64 of word x / 64; 0 behind the row.
  struct Row {
    std::vector<std::uint64_t> valid;     // the pixel has a disparity
    std::vector<std::uint64_t> left, up;  // it is connected with that neighbour
    std::vector<std::uint64_t> starts;    // a run starts here
    std::vector<int> runs_before;         // runs of the row that start before a word
    int first_run = 0;
    /// Returns the run that contains pixel x.
    int run(int x) const;
  };
  struct Run {
    std::uint16_t begin, end;  // px; end is one past the last
    int parent;                // a run of the same region; itself: the root
    int area;                  // px of the region, valid in its root
  };

  void label(const cv::Mat1w& disparity, int y, int range);
  void add_runs(Row& row);
  void join_rows(const Row& row, const Row& above);
  void decide(cv::Mat1w& disparity, int y, int size);
  int root(int run);
  void join(int a, int b);

  Row rows_[2];                           // the latest two
  std::vector<Run> runs_;                 // in raster order
  std::vector<int> first_run_;            // of each row; the last entry is the number of runs
  std::vector<std::uint16_t> empty_row_;  // the row above the image
};

/// Where connect_row() writes the bits of a row.
struct ConnectedRow {
  std::uint64_t *valid, *left, *up;
};
/// Finds the connected pixels of a row. Reads one pixel in front of the row and up to 63 behind it.
void connect_row(const std::uint16_t* row, const std::uint16_t* above, int width, int range,
                 const ConnectedRow& out);

}  // namespace fpga_stereo::simd
