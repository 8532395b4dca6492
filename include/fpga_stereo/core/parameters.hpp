// The parameters of the pipeline: one struct, one table. The command line, ROS and the
// documentation all read the table, so a name, a range or a default is written once.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Which neighbours the census transform compares with the centre of its window.
enum class CensusPattern {
  kSparse,  // row and column offset both even, without the centre: 24 bits at 11 x 11
  kFull,    // every neighbour, the paper's: 120 bits at 11 x 11
};

struct Parameters {
  int min_disparity = 0;             // px
  int disparity_range = 64;          // disparities searched
  int correlation_window_size = 15;  // px
  int census_window_size = 11;       // px
  CensusPattern census_pattern = CensusPattern::kSparse;
  double uniqueness_ratio = 33.0;  // percent
  int disp12MaxDiff = 1;           // px; the name that OpenCV and stereo_image_proc use
  int speckle_size = 400;          // px, area
  int speckle_range = 1;           // px
  bool left_right_check = true;
  bool uniqueness_check = true;
  bool subpixel = true;
};

/// One row of the parameter table.
struct ParameterInfo {
  using Member = std::variant<int Parameters::*, double Parameters::*, bool Parameters::*,
                              CensusPattern Parameters::*>;
  std::string name;
  Member member;
  double min = 0;     // numbers only
  double max = 0;     // numbers only
  int step = 1;       // integers only: allowed are min, min + step, ...
  std::string unit;   // "px", "percent", ""
  std::string about;  // one line for people
};

/// Every parameter, in the order of the stages.
const std::vector<ParameterInfo>& parameter_table();

/// What a value may be, for messages: "8 to 256 in steps of 4", "true or false".
std::string allowed_values(const ParameterInfo& info);

/// "sparse" or "full".
std::string to_text(CensusPattern pattern);

/// The value of one parameter as text.
std::string to_text(const Parameters& parameters, const ParameterInfo& info);

/// Sets the parameter called `name` from text. Refuses an unknown name, text that is no such
/// value and a value out of range; `parameters` is then unchanged.
Status set_parameter(Parameters& parameters, const std::string& name, const std::string& text);

/// N of the uniqueness check: kUniquenessScale (1 + uniqueness_ratio / 100), rounded half away from
/// zero.
int uniqueness_factor(const Parameters& parameters);

/// Refuses the first parameter that is out of range, by name, value and range.
Status validate(const Parameters& parameters);

}  // namespace fpga_stereo
