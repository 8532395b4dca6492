// aggregate: sums of path costs of a row, for semi-global matching.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/layout.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo::simd {

/// Sums of path costs of a row: pixel x has S(x, y, d) at sums + x pitch, with kLaneGroup lanes of
/// kNoPathSum on both sides.
struct PathSums {
  std::uint8_t* sums;
  std::ptrdiff_t pitch;
  int width, range, lanes;

  std::uint8_t* column(int x) const { return sums + x * pitch; }
};
constexpr std::uint8_t kNoPathSum = 0xFF;  // larger than every sum

/// Owns the memory of PathSums.
class PathSumsBuffer {
 public:
  void create(int width, int disparity_range);
  const PathSums& sums() const { return sums_; }

 private:
  cv::Mat1b bytes_;
  PathSums sums_{};
};

/// What the paths from above carry from row to row. Rows must pass it on in order.
class VerticalPaths {
 public:
  void start(int width, const Parameters& p);
  /// Sets `sums` of row `y` to the contribution of the paths from above. `guide` is the left image,
  /// smoothed.
  void next(const cv::Mat1b& guide, int y, const std::uint8_t* costs, const PathSums& sums);

 private:
  Parameters parameters_;
  cv::Mat1b paths_;                          // N of the row above, W x lanes, and a pixel more
  std::vector<std::uint8_t> p2_, p2_right_;  // penalties of the steps from above
};

/// Adds the contributions of the paths from the left and, in the full build, from the right.
class HorizontalPaths {
 public:
  void start(int width, const Parameters& p);
  void add(const cv::Mat1b& guide, int y, const std::uint8_t* costs, const PathSums& sums);

 private:
  Parameters parameters_;
  std::vector<std::uint8_t> p2_;     // of the step between pixels x - 1 and x
  std::vector<std::uint8_t> state_;  // of both paths
};

// The kernels.

/// Penalties P2 for `count` pairs of grey values.
void penalties(const std::uint8_t* a, const std::uint8_t* b, int count, const Parameters& p,
               std::uint8_t* p2);
/// Path from above. `paths` has N of the row above and receives that of this row.
void vertical_path(const std::uint8_t* costs, const std::uint8_t* p2, int p1, std::uint8_t* paths,
                   const PathSums& sums);
/// Paths from above and from the upper right. N of the column behind the row must be 0.
void vertical_path_pair(const std::uint8_t* costs, const std::uint8_t* p2,
                        const std::uint8_t* p2_right, int p1, std::uint8_t* paths,
                        const PathSums& sums);
/// Paths from the left and, with `both`, from the right; `state` has 2 lanes bytes.
void horizontal_paths(const std::uint8_t* costs, const std::uint8_t* p2, int p1, bool both,
                      std::uint8_t* state, const PathSums& sums);

}  // namespace fpga_stereo::simd
