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
  int truth_scale;       // units of the ground truth per px
  int disparity_range;   // search range of the benchmark
  bool has_whole_truth;  // the ground truth is whole pixels
};
constexpr std::array<MiddleburyScene, 4> kMiddleburyScenes{{{"tsukuba", 16, 16, true},
                                                            {"venus", 8, 20, false},
                                                            {"teddy", 4, 60, false},
                                                            {"cones", 4, 60, false}}};

/// Evaluated pixels: those seen by both cameras, all with known truth, those near a depth edge.
enum Region { kNonOccluded, kAll, kDiscontinuities };
constexpr std::array<const char*, 3> kRegionNames{"nonocc", "all", "disc"};

struct MiddleburyPair {
  MiddleburyScene scene;
  cv::Mat1b left, right;           // grey
  cv::Mat1b truth;                 // in units of 1 / scene.truth_scale px
  std::array<cv::Mat1b, 3> masks;  // by Region; 255 = evaluated
};

/// Reads FOLDER/<scene>. Throws std::runtime_error for missing files and unequal sizes.
MiddleburyPair read_pair(const std::string& folder, const MiddleburyScene& scene);

/// Pixel counts of one region.
struct Score {
  std::int64_t evaluated = 0;  // pixels of the region
  std::int64_t valid = 0;      // evaluated pixels with a disparity
  std::int64_t bad = 0;        // valid pixels with an error above 1.0 px; the others are good
  double squares = 0;          // sum of the squared errors of good pixels, px^2

  /// Returns the percentage of evaluated pixels that are bad or have no disparity.
  double bad_of_all() const;
  /// Returns the percentage of valid pixels that are bad; 0 if no pixel is valid.
  double bad_of_valid() const;
  /// Returns the percentage of evaluated pixels that have a disparity.
  double coverage() const;
  /// Returns the RMS error of good pixels, px; 0 if no pixel is good.
  double rms_of_good() const;
};

/// Compares a disparity image (1/32 px, `min_disparity` not added) with the ground truth.
Score score(const MiddleburyPair& pair, Region region, const cv::Mat1w& disparity,
            int min_disparity);

/// Returns a picture: black = correct, white = bad, grey = not evaluated. A pixel without a
/// disparity is white if `holes_count`, else grey.
cv::Mat1b error_picture(const MiddleburyPair& pair, Region region, const cv::Mat1w& disparity,
                        int min_disparity, bool holes_count);

}  // namespace fpga_stereo::tools
