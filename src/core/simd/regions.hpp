// speckle by runs of connected pixels, which are few, in the place of pixels.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fpga_stereo::simd {

/// The bits of the scalar twin, speckle().
class Regions {
 public:
  /// `disparity` has one pixel of kNoDisparity before each row and kBorder bytes behind it. In
  /// place. `range` in 1/32 px.
  void remove_small(cv::Mat1w& disparity, int range, int size);

 private:
  struct Row {
    std::vector<std::uint64_t> valid, left, up, starts;
    std::vector<int> before;  // runs before the first one that starts in a word
    int first = 0;            // its first run
    /// The run that pixel x is in.
    int run(int x) const;
  };
  struct Run {
    std::uint16_t begin, end;  // px; end is behind it
    int parent, area;          // area: of the root of a region
  };

  void label(const cv::Mat1w& disparity, int y, int range);
  void add_runs(Row& row);
  void join_rows(const Row& row, const Row& above);
  void decide(cv::Mat1w& disparity, int y, int size);
  int root(int run);
  void join(int a, int b);

  Row rows_[2];                      // the latest two
  std::vector<Run> runs_;            // in raster order
  std::vector<int> first_run_;       // of every row, and the end of all
  std::vector<std::uint16_t> none_;  // the row above the image
};

}  // namespace fpga_stereo::simd
