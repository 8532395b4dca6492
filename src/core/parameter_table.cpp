// Generated from fpga_fw/spec/spec.yaml by fpga_fw/tools/generate_spec: do not edit.
#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {
namespace {

/// Returns the number in a field in which 0 stands for 2^width.
int modulo(spec::Field field, std::uint32_t word) {
  const auto value = static_cast<int>(field.get(word));
  return value == 0 ? 1 << field.bits : value;
}

}  // namespace

// clang-format off
const std::vector<ParameterInfo>& parameter_table() {
  static const std::vector<ParameterInfo> table{
      {"min_disparity", &Parameters::min_disparity, -128, 128, 1, "px", {}, false,
       "smallest disparity searched; a larger value brings the search range closer"},
      {"disparity_range", &Parameters::disparity_range, 8, 256, 4, "px", {}, true,
       "number of disparities searched; time grows with it"},
      {"stereo_algorithm", &Parameters::stereo_algorithm, 0, 1, 1, "", {"window", "sgm"}, true,
       "algorithm that finds the disparities"},
      {"sgm_build", &Parameters::sgm_build, 0, 1, 1, "", {"full", "small"}, true,
       "paths along which semi-global matching adds costs; full has fewer errors"},
      {"dense", &Parameters::dense, 0, 1, 1, "", {}, true,
       "give every pixel a disparity: fill the gaps and smooth; turns the uniqueness check off"},
      {"census_window_size", &Parameters::census_window_size, 5, 11, 2, "px", {}, true,
       "side of the census window"},
      {"census_pattern", &Parameters::census_pattern, 0, 1, 1, "", {"sparse", "full"}, true,
       "neighbours that the census transform compares with the centre of its window"},
      {"correlation_window_size", &Parameters::correlation_window_size, 5, 21, 2, "px", {}, true,
       "side of the window for sums: large is smooth, small is detailed"},
      {"cost_difference_limit", &Parameters::cost_difference_limit, 0, 31, 1, "", {}, false,
       "limit of the grey difference in the cost of a pixel; 0: only census bits count"},
      {"cost_difference_shift", &Parameters::cost_difference_shift, 0, 4, 1, "bit", {}, false,
       "each step halves the weight of the grey difference against that of a census bit"},
      {"cost_outside", &Parameters::cost_outside, 0, 31, 1, "", {}, false,
       "cost of a pixel whose counterpart would lie outside the right image"},
      {"cost_shift", &Parameters::cost_shift, 0, 6, 1, "bit", {}, false,
       "each step halves the matching cost against the penalties"},
      {"sgm_p1", &Parameters::sgm_p1, 0, 15, 1, "", {}, false,
       "penalty for a disparity step of 1 px between neighbours; not the P1 of stereo_image_proc"},
      {"sgm_p2", &Parameters::sgm_p2, 6, 15, 1, "", {}, false,
       "penalty for a larger step between pixels of similar grey"},
      {"sgm_p2_edge", &Parameters::sgm_p2_edge, 6, 15, 1, "", {}, false,
       "penalty for a larger step at an edge of the image"},
      {"sgm_p2_strong_edge", &Parameters::sgm_p2_strong_edge, 6, 15, 1, "", {}, false,
       "penalty for a larger step at a strong edge"},
      {"sgm_edge", &Parameters::sgm_edge, 0, 255, 1, "", {}, false,
       "grey difference of neighbours, in the smoothed image, from which there is an edge"},
      {"sgm_strong_edge", &Parameters::sgm_strong_edge, 0, 255, 1, "", {}, false,
       "grey difference from which the edge is strong"},
      {"left_right_check", &Parameters::left_right_check, 0, 1, 1, "", {}, false,
       "drop pixels where the search from the right image disagrees"},
      {"disp12MaxDiff", &Parameters::disp12MaxDiff, 0, 128, 1, "px", {}, false,
       "largest difference that the left-right check allows"},
      {"uniqueness_check", &Parameters::uniqueness_check, 0, 1, 1, "", {}, false,
       "drop pixels whose best match is not clearly better than the runner-up"},
      {"uniqueness_ratio", &Parameters::uniqueness_ratio, 0, 100, 1, "percent", {}, false,
       "how much worse the runner-up must be"},
      {"subpixel", &Parameters::subpixel, 0, 1, 1, "", {}, false,
       "refine disparities to 1/32 px; otherwise whole pixels"},
      {"speckle_size", &Parameters::speckle_size, 0, 1000, 1, "px", {}, false,
       "drop connected regions of fewer pixels; 0 turns the filter off"},
      {"speckle_range", &Parameters::speckle_range, 0, 31, 1, "px", {}, false,
       "largest disparity step between neighbours of one region"},
      {"median_difference", &Parameters::median_difference, 0, 255, 1, "", {}, false,
       "the median of a pixel includes those whose grey value differs by no more than this"},
  };
  return table;
}

std::string to_text(StereoAlgorithm value) {
  constexpr const char* kNames[]{"window", "sgm"};
  return kNames[static_cast<int>(value)];
}

std::string to_text(SgmBuild value) {
  constexpr const char* kNames[]{"full", "small"};
  return kNames[static_cast<int>(value)];
}

std::string to_text(CensusPattern value) {
  constexpr const char* kNames[]{"sparse", "full"};
  return kNames[static_cast<int>(value)];
}

std::vector<RegisterWrite> parameter_registers(const Parameters& p) {
  return {
      {spec::kRegFlags,
           spec::kFlagsLeftRightCheck.put(p.left_right_check) |
           spec::kFlagsUniquenessCheck.put(p.uniqueness_check) |
           spec::kFlagsSubpixel.put(p.subpixel)},
      {spec::kRegDisp12MaxDiff,
           spec::kDisp12MaxDiffPixels.put(p.disp12MaxDiff)},
      {spec::kRegUniqueness,
           spec::kUniquenessFactor.put(uniqueness_factor(p))},
      {spec::kRegSpeckleSize,
           spec::kSpeckleSizePixels.put(p.speckle_size)},
      {spec::kRegSpeckleRange,
           spec::kSpeckleRangeUnits.put(p.speckle_range * kDisparityScale)},
  };
}

std::uint32_t build_fields(const Parameters& p) {
  return spec::kBuildDisparities.put(p.disparity_range) |
           spec::kBuildCensusWindow.put(p.census_window_size) |
           spec::kBuildCorrelationWindow.put(p.correlation_window_size) |
           spec::kBuildCensusFull.put(static_cast<std::uint32_t>(p.census_pattern));
}

void set_parameters(Parameters& p, std::uint32_t address, std::uint32_t word) {
  switch (address) {
    case spec::kRegBuild:
      p.disparity_range = modulo(spec::kBuildDisparities, word);
      p.census_window_size = static_cast<int>(spec::kBuildCensusWindow.get(word));
      p.correlation_window_size = static_cast<int>(spec::kBuildCorrelationWindow.get(word));
      p.census_pattern = static_cast<CensusPattern>(spec::kBuildCensusFull.get(word));
      break;
    case spec::kRegFlags:
      p.left_right_check = spec::kFlagsLeftRightCheck.get(word) != 0;
      p.uniqueness_check = spec::kFlagsUniquenessCheck.get(word) != 0;
      p.subpixel = spec::kFlagsSubpixel.get(word) != 0;
      break;
    case spec::kRegDisp12MaxDiff:
      p.disp12MaxDiff = static_cast<int>(spec::kDisp12MaxDiffPixels.get(word));
      break;
    case spec::kRegUniqueness:
      p.uniqueness_ratio = uniqueness_ratio_of(static_cast<int>(spec::kUniquenessFactor.get(word)));
      break;
    case spec::kRegSpeckleSize:
      p.speckle_size = static_cast<int>(spec::kSpeckleSizePixels.get(word));
      break;
    case spec::kRegSpeckleRange:
      p.speckle_range = static_cast<int>(spec::kSpeckleRangeUnits.get(word)) / kDisparityScale;
      break;
    default:
      break;
  }
}
// clang-format on

}  // namespace fpga_stereo
