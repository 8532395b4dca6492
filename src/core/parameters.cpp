#include "fpga_stereo/core/parameters.hpp"

#include <cmath>
#include <sstream>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {
namespace {

constexpr const char* kSparseName = "sparse";
constexpr const char* kFullName = "full";

ParameterInfo integer(std::string name, int Parameters::*member, int min, int max, int step,
                      std::string unit, std::string about) {
  return {std::move(name), member,          double(min), double(max), step,
          std::move(unit), std::move(about)};
}

ParameterInfo flag(std::string name, bool Parameters::*member, std::string about) {
  return {std::move(name), member, 0, 1, 1, "", std::move(about)};
}

/// Text without trailing zeros: 33, 0.5.
std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

template <class T>
bool parse(const std::string& text, T& value) {
  std::istringstream stream(text);
  return stream >> std::noskipws >> value && stream.eof();
}

bool parse(const std::string& text, bool& value) {
  value = text == "true" || text == "1";
  return value || text == "false" || text == "0";
}

bool parse(const std::string& text, CensusPattern& value) {
  value = text == kFullName ? CensusPattern::kFull : CensusPattern::kSparse;
  return text == kFullName || text == kSparseName;
}

bool in_range(const ParameterInfo& info, double value) {
  return value >= info.min && value <= info.max;  // false for NaN
}

bool in_range(const ParameterInfo& info, int value) {
  const int min = static_cast<int>(info.min);
  return value >= min && value <= static_cast<int>(info.max) && (value - min) % info.step == 0;
}

bool in_range(const ParameterInfo& /*info*/, bool /*value*/) { return true; }
bool in_range(const ParameterInfo& /*info*/, CensusPattern /*value*/) { return true; }

Error refusal(const ParameterInfo& info, const std::string& text) {
  return {ErrorKind::kInvalid, info.name + " = " + text + ": allowed " + allowed_values(info)};
}

}  // namespace

const std::vector<ParameterInfo>& parameter_table() {
  using P = Parameters;
  static const std::vector<ParameterInfo> table{
      integer("min_disparity", &P::min_disparity, -128, 128, 1, "px",
              "smallest disparity searched; moves the search towards the camera"),
      integer("disparity_range", &P::disparity_range, 8, 256, 4, "px",
              "number of disparities searched"),
      integer("census_window_size", &P::census_window_size, 5, 11, 2, "px",
              "side of the census window, odd"),
      {"census_pattern", &P::census_pattern, 0, 1, 1, "",
       "neighbours compared: sparse (even offsets) or full (the paper's)"},
      integer("correlation_window_size", &P::correlation_window_size, 5, 21, 2, "px",
              "side of the window that sums are taken over, odd"),
      flag("left_right_check", &P::left_right_check,
           "drop pixels on which the search from the right image disagrees"),
      integer("disp12MaxDiff", &P::disp12MaxDiff, 0, 128, 1, "px",
              "largest difference that left_right_check allows"),
      flag("uniqueness_check", &P::uniqueness_check,
           "drop pixels whose best match is not clearly better than its rivals"),
      {"uniqueness_ratio", &P::uniqueness_ratio, 0, 100, 1, "percent",
       "how much worse every rival must be"},
      flag("subpixel", &P::subpixel, "refine to 1/32 px; otherwise whole pixels"),
      integer("speckle_size", &P::speckle_size, 0, kSpeckleMax, 1, "px",
              "regions of fewer pixels are dropped; 0 switches this off"),
      integer("speckle_range", &P::speckle_range, 0, 31, 1, "px",
              "largest step between neighbours of one region"),
  };
  return table;
}

std::string allowed_values(const ParameterInfo& info) {
  if (std::holds_alternative<bool Parameters::*>(info.member)) return "true or false";
  if (std::holds_alternative<CensusPattern Parameters::*>(info.member)) {
    return std::string(kSparseName) + " or " + kFullName;
  }
  std::string text = number(info.min) + " to " + number(info.max);
  if (info.step > 1) text += " in steps of " + std::to_string(info.step);
  return text;
}

std::string to_text(CensusPattern pattern) {
  return pattern == CensusPattern::kFull ? kFullName : kSparseName;
}

std::string to_text(const Parameters& parameters, const ParameterInfo& info) {
  struct Writer {
    std::string operator()(int value) const { return std::to_string(value); }
    std::string operator()(double value) const { return number(value); }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(CensusPattern value) const { return to_text(value); }
  };
  return std::visit([&](auto member) { return Writer{}(parameters.*member); }, info.member);
}

Status set_parameter(Parameters& parameters, const std::string& name, const std::string& text) {
  for (const ParameterInfo& info : parameter_table()) {
    if (info.name != name) continue;
    const bool accepted = std::visit(
        [&](auto member) {
          auto value = parameters.*member;
          if (!parse(text, value) || !in_range(info, value)) return false;
          parameters.*member = value;
          return true;
        },
        info.member);
    if (accepted) return {};
    return refusal(info, "\"" + text + "\"");
  }
  std::string names;
  for (const ParameterInfo& info : parameter_table()) names += " " + info.name;
  return Error{ErrorKind::kInvalid, "unknown parameter \"" + name + "\": known are" + names};
}

int uniqueness_factor(const Parameters& parameters) {
  return static_cast<int>(std::lround(kUniquenessScale * (1 + parameters.uniqueness_ratio / 100)));
}

Status validate(const Parameters& parameters) {
  for (const ParameterInfo& info : parameter_table()) {
    const bool accepted =
        std::visit([&](auto member) { return in_range(info, parameters.*member); }, info.member);
    if (!accepted) return refusal(info, to_text(parameters, info));
  }
  return {};
}

}  // namespace fpga_stereo
