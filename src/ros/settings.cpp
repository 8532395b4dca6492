#include "ros/settings.hpp"

#include <dynamic_reconfigure/Config.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <thread>

namespace fpga_stereo {
namespace {

template <class T>
std::string text_of(const T& value) {
  std::ostringstream text;
  text << std::boolalpha << value;
  return text.str();
}

dynamic_reconfigure::Config to_message(const StereoConfig& config) {
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  return message;
}

/// Returns the values of all parameters as text, by name.
std::map<std::string, std::string> texts(const StereoConfig& config) {
  std::map<std::string, std::string> values;
  const dynamic_reconfigure::Config message = to_message(config);
  for (const auto& p : message.ints) values[p.name] = text_of(p.value);
  for (const auto& p : message.doubles) values[p.name] = text_of(p.value);
  for (const auto& p : message.strs) values[p.name] = p.value;
  for (const auto& p : message.bools) values[p.name] = text_of(p.value != 0);
  return values;
}

/// Returns the allowed values of the text parameters of the outputs.
const std::map<std::string, std::vector<std::string>>& choices() {
  static const std::map<std::string, std::vector<std::string>> table{
      {"cloud_fields", {"rgb", "mono", "xyz"}}, {"depth_encoding", {"32FC1", "16UC1"}}};
  return table;
}

std::string join_with_or(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " or ") + name;
  return text;
}

/// Returns nullopt if `value` is allowed for the parameter `name`, otherwise a text that says what
/// is.
std::optional<std::string> allowed_instead(const std::string& name, const std::string& value) {
  for (const ParameterInfo& info : parameter_table()) {
    Parameters scratch;
    if (info.name == name) {
      if (set_parameter(scratch, name, value)) return std::nullopt;
      return allowed_values(info);
    }
  }
  if (const auto found = choices().find(name); found != choices().end()) {
    const auto& names = found->second;
    if (std::count(names.begin(), names.end(), value) != 0) return std::nullopt;
    return join_with_or(names);
  }
  static const auto min = texts(StereoConfig::__getMin__());
  static const auto max = texts(StereoConfig::__getMax__());
  if (min.at(name) == "false") {
    if (value == "true" || value == "false") return std::nullopt;
    return "true or false";
  }
  std::istringstream stream(value);
  double number = 0;
  const bool is_number = stream >> number && stream.eof();
  if (is_number && number >= std::stod(min.at(name)) && number <= std::stod(max.at(name))) {
    return std::nullopt;
  }
  return min.at(name) + " to " + max.at(name);
}

/// Returns true if the parameter has the type that dynamic_reconfigure reads; it ignores others.
bool has_its_type(const ros::NodeHandle& nh, const std::string& name) {
  const dynamic_reconfigure::Config message = to_message(StereoConfig::__getDefault__());
  const auto readable = [&](const auto& parameters, auto value) {
    return std::any_of(parameters.begin(), parameters.end(),
                       [&](const auto& p) { return p.name == name && nh.getParam(name, value); });
  };
  return readable(message.ints, 0) || readable(message.doubles, 0.0) ||
         readable(message.strs, std::string()) || readable(message.bools, false);
}

/// Returns the allowed number that is nearest to `value`; nullopt if the value is not a number.
std::optional<double> nearest_number(const std::string& name, XmlRpc::XmlRpcValue& value) {
  using Type = XmlRpc::XmlRpcValue::Type;
  if (value.getType() != Type::TypeInt && value.getType() != Type::TypeDouble) return std::nullopt;
  const double number =
      value.getType() == Type::TypeInt ? static_cast<int&>(value) : static_cast<double&>(value);
  if (std::isnan(number)) return std::nullopt;
  for (const ParameterInfo& info : parameter_table()) {
    if (info.name == name) return nearest_allowed(info, number);
  }
  return std::clamp(number, std::stod(texts(StereoConfig::__getMin__()).at(name)),
                    std::stod(texts(StereoConfig::__getMax__()).at(name)));
}

/// Sets the parameter to a number of its type.
void set_number(const ros::NodeHandle& nh, const std::string& name, double number) {
  const dynamic_reconfigure::Config defaults = to_message(StereoConfig::__getDefault__());
  const bool is_whole = std::any_of(defaults.ints.begin(), defaults.ints.end(),
                                    [&](const auto& p) { return p.name == name; });
  if (is_whole) {
    nh.setParam(name, static_cast<int>(number));
  } else {
    nh.setParam(name, number);
  }
}

/// Copies the value of `name` from `from` to `config`.
void restore(StereoConfig& config, const StereoConfig& from, const std::string& name) {
  const dynamic_reconfigure::Config source = to_message(from);
  dynamic_reconfigure::Config target = to_message(config);
  const auto copy = [&](const auto& in, auto& out) {
    for (std::size_t i = 0; i < in.size(); ++i) {
      if (in[i].name == name) out[i] = in[i];
    }
  };
  copy(source.ints, target.ints);
  copy(source.doubles, target.doubles);
  copy(source.strs, target.strs);
  copy(source.bools, target.bools);
  config.__fromMessage__(target);
}

}  // namespace

void check_parameters(const ros::NodeHandle& private_nh, ParameterReport& report) {
  for (const auto& [name, default_value] : texts(StereoConfig::__getDefault__())) {
    report.names.insert(name);
    XmlRpc::XmlRpcValue value;
    if (!private_nh.getParam(name, value)) continue;
    const bool readable = has_its_type(private_nh, name);
    const auto allowed = allowed_instead(name, readable ? text_of(value) : "");
    if (!allowed) continue;
    if (const auto nearest = readable ? nearest_number(name, value) : std::nullopt) {
      report.warnings.push_back(refusal(name, text_of(value), *allowed, text_of(*nearest)));
      set_number(private_nh, name, *nearest);
      continue;
    }
    report.errors.push_back(
        refusal(name, readable ? text_of(value) : with_type(value), *allowed, default_value));
    private_nh.deleteParam(name);
  }
}

Settings to_settings(StereoConfig& config, const StereoConfig& accepted,
                     std::vector<std::string>& refusals) {
  const auto fallback = texts(accepted);
  for (const auto& [name, value] : texts(config)) {
    const auto allowed = allowed_instead(name, value);
    if (!allowed) continue;
    refusals.push_back(refusal(name, value, *allowed, fallback.at(name)));
    restore(config, accepted, name);
  }

  Settings settings;
  const auto values = texts(config);
  for (const ParameterInfo& info : parameter_table()) {
    // This cannot fail, because every value has just been checked.
    (void)set_parameter(settings.pipeline, info.name, values.at(info.name));
  }
  settings.cloud.color = config.cloud_fields == "rgb"    ? PointColor::kRgb
                         : config.cloud_fields == "mono" ? PointColor::kMono
                                                         : PointColor::kNone;
  settings.cloud.padded = config.cloud_padded;
  settings.cloud.organized = config.cloud_organized;
  settings.cloud.decimation = config.cloud_decimation;
  settings.cloud_max_rate = config.cloud_max_rate;
  settings.depth_encoding =
      config.depth_encoding == "16UC1" ? DepthEncoding::kMillimetres : DepthEncoding::kMetres;
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  settings.num_threads = config.num_threads == 0 ? cores : config.num_threads;
  return settings;
}

Settings load_settings(const ros::NodeHandle& private_nh, ParameterReport& report) {
  check_parameters(private_nh, report);
  const StereoConfig defaults = StereoConfig::__getDefault__();
  StereoConfig config = defaults;
  config.__fromServer__(private_nh);
  return to_settings(config, defaults, report.errors);
}

}  // namespace fpga_stereo
