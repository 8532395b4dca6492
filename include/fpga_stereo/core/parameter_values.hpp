// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
//
// The parameters of the pipeline with their defaults. parameters.hpp checks and converts them.
#pragma once

#include <string>
#include <variant>

namespace fpga_stereo {

/// Algorithm that finds the disparities.
enum class StereoAlgorithm {
  kWindow,  // window matching, as in the paper
  kSgm,     // semi-global matching: sharp edges, few gaps
};
/// Returns the value's name: window or sgm.
std::string to_text(StereoAlgorithm value);

/// Paths along which semi-global matching adds costs; full has fewer errors.
enum class SgmBuild {
  kFull,   // paths from the left, from the right and from above
  kSmall,  // paths from the left and from above: less gateware, more errors
};
/// Returns the value's name: full or small.
std::string to_text(SgmBuild value);

/// Neighbours that the census transform compares with the centre of its window.
enum class CensusPattern {
  kSparse,  // row and column offset both even, without the centre: 24 bits at 11 x 11
  kFull,    // every neighbour, as in the paper: 120 bits at 11 x 11
};
/// Returns the value's name: sparse or full.
std::string to_text(CensusPattern value);

/// Parameters of the pipeline, in the order of the stages.
struct Parameters {
  /// Smallest disparity searched; a larger value brings the search range closer (px, -128 to 128).
  int min_disparity = 0;
  /// Number of disparities searched; time grows with it (px, 8 to 256 in steps of 4).
  int disparity_range = 64;
  /// Algorithm that finds the disparities.
  StereoAlgorithm stereo_algorithm = StereoAlgorithm::kSgm;
  /// Paths along which semi-global matching adds costs; full has fewer errors.
  SgmBuild sgm_build = SgmBuild::kFull;
  /// Give every pixel a disparity: fill the gaps and smooth; turns the uniqueness check off.
  bool dense = false;
  /// Side of the census window (px, 5 to 11 in steps of 2).
  int census_window_size = 11;
  /// Neighbours that the census transform compares with the centre of its window.
  CensusPattern census_pattern = CensusPattern::kSparse;
  /// Side of the window for sums: large is smooth, small is detailed (px, 5 to 21 in steps of 2).
  int correlation_window_size = 15;
  /// Limit of the grey difference in the cost of a pixel; 0: only census bits count (no unit, 0 to
  /// 31).
  int cost_difference_limit = 8;
  /// Each step halves the weight of the grey difference against that of a census bit (bit, 0 to 4).
  int cost_difference_shift = 2;
  /// Cost of a pixel whose counterpart would lie outside the right image (no unit, 0 to 31).
  int cost_outside = 5;
  /// Each step halves the matching cost against the penalties (bit, 0 to 6).
  int cost_shift = 2;
  /// Penalty for a disparity step of 1 px between neighbours; not the P1 of stereo_image_proc (no
  /// unit, 0 to 15).
  int sgm_p1 = 5;
  /// Penalty for a larger step between pixels of similar grey (no unit, 6 to 15).
  int sgm_p2 = 15;
  /// Penalty for a larger step at an edge of the image (no unit, 6 to 15).
  int sgm_p2_edge = 10;
  /// Penalty for a larger step at a strong edge (no unit, 6 to 15).
  int sgm_p2_strong_edge = 7;
  /// Grey difference of neighbours, in the smoothed image, from which there is an edge (no unit, 0
  /// to 255).
  int sgm_edge = 5;
  /// Grey difference from which the edge is strong (no unit, 0 to 255).
  int sgm_strong_edge = 14;
  /// Drop pixels where the search from the right image disagrees.
  bool left_right_check = true;
  /// Largest difference that the left-right check allows (px, 0 to 128).
  int disp12MaxDiff = 1;
  /// Drop pixels whose best match is not clearly better than the runner-up.
  bool uniqueness_check = true;
  /// How much worse the runner-up must be (percent, 0 to 100).
  double uniqueness_ratio = 33.0;
  /// Refine disparities to 1/32 px; otherwise whole pixels.
  bool subpixel = true;
  /// Drop connected regions of fewer pixels; 0 turns the filter off (px, 0 to 1000).
  int speckle_size = 40;
  /// Largest disparity step between neighbours of one region (px, 0 to 31).
  int speckle_range = 1;
  /// The median of a pixel includes those whose grey value differs by no more than this (no unit, 0
  /// to 255).
  int median_difference = 8;
};

// clang-format off
/// A member of Parameters.
using ParameterMember = std::variant<
    int Parameters::*,
    double Parameters::*,
    bool Parameters::*,
    StereoAlgorithm Parameters::*,
    SgmBuild Parameters::*,
    CensusPattern Parameters::*>;
// clang-format on

}  // namespace fpga_stereo
