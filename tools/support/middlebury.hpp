// The Middlebury stereo evaluation, version 2 (D. Scharstein, R. Szeliski, "A taxonomy and
// evaluation of dense two-frame stereo correspondence algorithms", IJCV 47, 2002).
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

namespace fpga_stereo::tools {

struct MiddleburyScene {
  const char* name;
  int truth_scale;      // ground truth is px times this
  int disparity_range;  // disparities that the benchmark searches
};
constexpr std::array<MiddleburyScene, 4> kMiddleburyScenes{
    {{"tsukuba", 16, 16}, {"venus", 8, 20}, {"teddy", 4, 60}, {"cones", 4, 60}}};

/// What is evaluated: pixels seen by both cameras, all with known truth, those near a depth edge.
enum Region { kNonOccluded, kAll, kDiscontinuities };
constexpr std::array<const char*, 3> kRegionNames{"nonocc", "all", "disc"};

struct MiddleburyPair {
  MiddleburyScene scene;
  cv::Mat1b left, right;           // grey
  cv::Mat1b truth;                 // px times scene.truth_scale
  std::array<cv::Mat1b, 3> masks;  // by Region; 255 = evaluated
};

/// Reads FOLDER/<scene>. Throws std::runtime_error that names what is absent or does not fit.
MiddleburyPair read_pair(const std::string& folder, const MiddleburyScene& scene);

/// Counts over one region.
struct Score {
  std::int64_t evaluated = 0;  // pixels of the region
  std::int64_t valid = 0;      // of these, with a disparity
  std::int64_t bad = 0;        // of the valid ones, more than 1.0 px off

  /// Percent of the region that is bad or has no disparity.
  double bad_of_all() const;
  /// Percent of the valid pixels that is bad; 0 where there is none.
  double bad_of_valid() const;
  /// Percent of the region that has a disparity.
  double coverage() const;
};

Score score(const MiddleburyPair& pair, Region region, const cv::Mat1w& disparity,
            int min_disparity);

/// A picture: black = right, white = bad, grey = outside the region or, where `holes_count` is
/// false, without a disparity.
cv::Mat1b error_picture(const MiddleburyPair& pair, Region region, const cv::Mat1w& disparity,
                        int min_disparity, bool holes_count);

/// Each pixel without a disparity takes the smaller of the nearest ones to its left and right in
/// the row: what is hidden belongs to the background. A row without any stays as it is.
cv::Mat1w fill_holes(const cv::Mat1w& disparity);

}  // namespace fpga_stereo::tools
