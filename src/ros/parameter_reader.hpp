// Reads parameters at the start of the node. A number out of range becomes the nearest allowed one;
// a value of a wrong type and a text that means nothing keep the default. A message says so.
#pragma once

#include <ros/node_handle.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace fpga_stereo {

/// Returns the value as text.
std::string text_of(XmlRpc::XmlRpcValue& value);
/// Returns value and type, for example "1 (a whole number)".
std::string with_type(XmlRpc::XmlRpcValue& value);

/// Returns "name = value: allowed ...; using ...".
std::string refusal(const std::string& name, const std::string& value, const std::string& allowed,
                    const std::string& used);

/// What the node says about the parameters that it finds at its start.
struct ParameterReport {
  std::vector<std::string> errors;    // refused values; the defaults are used
  std::vector<std::string> warnings;  // numbers out of range; the nearest allowed ones are used
  std::set<std::string> names;        // of the parameters that the node knows
};

class ParameterReader {
 public:
  /// Both arguments must outlive the reader.
  ParameterReader(const ros::NodeHandle& nh, ParameterReport& report) : nh_(nh), report_(report) {}

  // Each function sets `value` if the parameter is set and allowed, and a number also if it is out
  // of range. A whole number is also allowed for a double.
  void number(const std::string& name, int min, int max, int& value);
  void number(const std::string& name, double min, double max, double& value);
  /// Allows numbers above 0, up to `max`. Zero and negative numbers keep the default.
  void positive_number(const std::string& name, double max, double& value);
  void flag(const std::string& name, bool& value);
  void text(const std::string& name, std::string& value);

  template <class T>
  void choice(const std::string& name, const std::map<std::string, T>& choices, T& value) {
    std::string allowed, used;
    for (const auto& [word, meaning] : choices) {
      allowed += (allowed.empty() ? "" : " or ") + word;
      if (meaning == value) used = word;
    }
    std::string word = used;
    if (!read(name, allowed, used, word)) return;
    if (const auto found = choices.find(word); found != choices.end()) {
      value = found->second;
    } else {
      report_.errors.push_back(refusal(name, word, allowed, used));
    }
  }

 private:
  /// Returns true if the parameter is set and has this type.
  template <class T>
  bool read(const std::string& name, const std::string& allowed, const std::string& used,
            T& value) {
    report_.names.insert(name);
    if (nh_.getParam(name, value)) return true;
    refuse_type(name, allowed, used);
    return false;
  }
  void refuse_type(const std::string& name, const std::string& allowed, const std::string& used);
  template <class T>
  void range(const std::string& name, T min, T max, T& value);

  const ros::NodeHandle& nh_;
  ParameterReport& report_;
};

}  // namespace fpga_stereo
