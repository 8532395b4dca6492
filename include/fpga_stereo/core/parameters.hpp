// The parameters of the pipeline: a struct and a table that describes each member. The command
// line, ROS and the documents all come from the table's source, fpga_fw/spec/spec.yaml, so each
// name, range and default is written once.
#pragma once

#include <string>
#include <vector>

#include "fpga_stereo/core/parameter_values.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Describes one parameter.
struct ParameterInfo {
  std::string name;
  ParameterMember member;
  double min;                        // numbers only
  double max;                        // numbers only
  int step;                          // integers only: allowed are min, min + step, ...
  std::string unit;                  // "px", "percent", ""
  std::vector<std::string> choices;  // enumerations only: a name for each value
  bool is_fixed_by_build;            // a gateware is built for one value
  std::string about;                 // one line for users
};

/// Returns every parameter, in the order of the stages.
const std::vector<ParameterInfo>& parameter_table();

/// Returns the defaults, but for window matching, which is what gatewares are built for.
Parameters window_parameters();

/// Returns the allowed values in words: "8 to 256 in steps of 4", "true or false".
std::string allowed_values(const ParameterInfo& info);

/// Returns the allowed number that is nearest to `value`, of two the larger one. For parameters
/// that are numbers; `value` must not be NaN.
double nearest_allowed(const ParameterInfo& info, double value);

/// Returns the value of one parameter as text.
std::string to_text(const Parameters& parameters, const ParameterInfo& info);

/// Sets the parameter called `name` from text. Refuses an unknown name, text that is not a value of
/// its type and a value out of range; `parameters` is then unchanged.
Status set_parameter(Parameters& parameters, const std::string& name, const std::string& text);

/// Returns the factor N of the uniqueness check: kUniquenessScale (1 + uniqueness_ratio / 100),
/// rounded half away from zero.
int uniqueness_factor(const Parameters& parameters);

/// Returns the uniqueness_ratio, in percent, with this uniqueness factor.
double uniqueness_ratio_of(int factor);

/// Refuses the first parameter that is out of range, by name, value and range.
Status validate(const Parameters& parameters);

}  // namespace fpga_stereo
