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

/// Costs L of the paths from above, of a row: W x lanes, and the smallest of each pixel. They are
/// the contribution of these paths to the sums.
struct VerticalCosts {
  cv::Mat1b costs;  // one pixel more, which counts 0
  std::vector<std::uint8_t> smallest;

  void create(int width, int disparity_range);
};

/// The paths from above.
class VerticalPaths {
 public:
  void start(int width, const Parameters& p);
  /// Computes row `y` from matching costs and the row above, which is ignored for y = 0. `guide` is
  /// the left image, smoothed.
  void next(const cv::Mat1b& guide, int y, const std::uint8_t* costs, const VerticalCosts& above,
            VerticalCosts& row);

 private:
  Parameters parameters_;
  std::vector<std::uint8_t> p2_, p2_right_;  // penalties of the steps from above
};

/// The paths from the left and, in the full build, from the right.
class HorizontalPaths {
 public:
  void start(int width, const Parameters& p);
  /// Sets `sums` of row `y` to the contributions of these paths and those from above.
  void next(const cv::Mat1b& guide, int y, const std::uint8_t* costs, const VerticalCosts& vertical,
            const PathSums& sums);

 private:
  Parameters parameters_;
  std::vector<std::uint8_t> p2_;     // of the step between pixels x - 1 and x
  std::vector<std::uint8_t> state_;  // of both paths
};

// The kernels.

/// Penalties P2 for `count` pairs of grey values.
void penalties(const std::uint8_t* a, const std::uint8_t* b, int count, const Parameters& p,
               std::uint8_t* p2);
/// What the kernels of a row read and write.
struct PathRow {
  const std::uint8_t* costs;  // C, W x lanes
  int width, lanes, p1;
};
/// Paths from above, and from the upper right where p2_right is not null. `above` and
/// `smallest_above` belong to the row above.
void vertical_paths(const PathRow& row, const std::uint8_t* p2, const std::uint8_t* p2_right,
                    const std::uint8_t* above, const std::uint8_t* smallest_above,
                    std::uint8_t* vertical, std::uint8_t* smallest);
/// Paths from the left and, with `both`, from the right; `state` has 2 lanes bytes.
void horizontal_paths(const PathRow& row, const std::uint8_t* p2, bool both,
                      const std::uint8_t* vertical, std::uint8_t* state, const PathSums& sums);

}  // namespace fpga_stereo::simd
