// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
//
// The parameters of the pipeline with their defaults. parameters.hpp checks and converts them.
#pragma once

#include <string>
#include <variant>

namespace fpga_stereo {

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
  /// Side of the census window (px, 5 to 11 in steps of 2).
  int census_window_size = 11;
  /// Neighbours that the census transform compares with the centre of its window.
  CensusPattern census_pattern = CensusPattern::kSparse;
  /// Side of the window for sums: large is smooth, small is detailed (px, 5 to 21 in steps of 2).
  int correlation_window_size = 15;
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
  int speckle_size = 400;
  /// Largest disparity step between neighbours of one region (px, 0 to 31).
  int speckle_range = 1;
};

// clang-format off
/// A member of Parameters.
using ParameterMember = std::variant<
    int Parameters::*,
    double Parameters::*,
    bool Parameters::*,
    CensusPattern Parameters::*>;
// clang-format on

}  // namespace fpga_stereo
