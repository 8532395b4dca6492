#include "fpga_stereo/core/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <type_traits>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {
namespace {

/// Returns a number as text without trailing zeros: 33, 0.5.
std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

/// Reads a value from text and returns true, or returns false if the text is not a value of its
/// type.
template <class T>
bool parse(const ParameterInfo& info, const std::string& text, T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    value = text == "true" || text == "1";
    return value || text == "false" || text == "0";
  } else if constexpr (std::is_enum_v<T>) {
    const auto found = std::find(info.choices.begin(), info.choices.end(), text);
    value = static_cast<T>(found - info.choices.begin());
    return found != info.choices.end();
  } else {
    std::istringstream stream(text);
    return stream >> std::noskipws >> value && stream.eof();
  }
}

template <class T>
bool is_in_range(const ParameterInfo& info, T value) {
  if constexpr (std::is_same_v<T, int>) {
    const int min = static_cast<int>(info.min);
    return value >= min && value <= static_cast<int>(info.max) && (value - min) % info.step == 0;
  } else if constexpr (std::is_same_v<T, double>) {
    return value >= info.min && value <= info.max;  // false for NaN
  } else {
    return true;
  }
}

Error refusal(const ParameterInfo& info, const std::string& text) {
  return {ErrorKind::kInvalid,
          fmt::format("{} = {}: allowed {}", info.name, text, allowed_values(info))};
}

}  // namespace

Parameters window_parameters() {
  Parameters parameters;
  parameters.stereo_algorithm = StereoAlgorithm::kWindow;
  return parameters;
}

std::string allowed_values(const ParameterInfo& info) {
  if (std::holds_alternative<bool Parameters::*>(info.member)) return "true or false";
  if (!info.choices.empty()) return fmt::format("{}", fmt::join(info.choices, " or "));
  std::string text = number(info.min) + " to " + number(info.max);
  if (info.step > 1) text += " in steps of " + std::to_string(info.step);
  return text;
}

double nearest_allowed(const ParameterInfo& info, double value) {
  const double inside = std::clamp(value, info.min, info.max);
  if (std::holds_alternative<double Parameters::*>(info.member)) return inside;
  const double steps = std::floor((inside - info.min) / info.step + 0.5);
  const double nearest = info.min + steps * info.step;
  return nearest <= info.max ? nearest : nearest - info.step;
}

std::string to_text(const Parameters& parameters, const ParameterInfo& info) {
  const auto text = [](auto value) -> std::string {
    using T = decltype(value);
    if constexpr (std::is_same_v<T, bool>) {
      return value ? "true" : "false";
    } else if constexpr (std::is_enum_v<T>) {
      return to_text(value);
    } else if constexpr (std::is_same_v<T, int>) {
      return std::to_string(value);
    } else {
      return number(value);
    }
  };
  return std::visit([&](auto member) { return text(parameters.*member); }, info.member);
}

Status set_parameter(Parameters& parameters, const std::string& name, const std::string& text) {
  for (const ParameterInfo& info : parameter_table()) {
    if (info.name != name) continue;
    const bool accepted = std::visit(
        [&](auto member) {
          auto value = parameters.*member;
          if (!parse(info, text, value) || !is_in_range(info, value)) return false;
          parameters.*member = value;
          return true;
        },
        info.member);
    if (accepted) return {};
    return refusal(info, "\"" + text + "\"");
  }
  std::string names;
  for (const ParameterInfo& info : parameter_table()) names += " " + info.name;
  return Error{ErrorKind::kInvalid,
               fmt::format("unknown parameter \"{}\": the parameters are{}", name, names)};
}

int uniqueness_factor(const Parameters& parameters) {
  return static_cast<int>(std::lround(kUniquenessScale * (1 + parameters.uniqueness_ratio / 100)));
}

double uniqueness_ratio_of(int factor) {
  return 100.0 * (factor - kUniquenessScale) / kUniquenessScale;
}

Status validate(const Parameters& parameters) {
  for (const ParameterInfo& info : parameter_table()) {
    const bool accepted =
        std::visit([&](auto member) { return is_in_range(info, parameters.*member); }, info.member);
    if (!accepted) return refusal(info, to_text(parameters, info));
  }
  return {};
}

}  // namespace fpga_stereo
