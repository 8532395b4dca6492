// Reads parameters at the start of the node. A value of a wrong type or range keeps its default,
// and a message says so.
#pragma once

#include <ros/node_handle.h>

#include <map>
#include <sstream>
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

class ParameterReader {
 public:
  /// Appends a message to `refusals` for each refused value. Both arguments must outlive the
  /// reader.
  ParameterReader(const ros::NodeHandle& nh, std::vector<std::string>& refusals)
      : nh_(nh), refusals_(refusals) {}

  // Each function sets `value` if the parameter is set and allowed. A whole number is also allowed
  // for a double.
  void number(const std::string& name, int min, int max, int& value);
  /// Allows `min` to `max`; `min` itself only if `inclusive`.
  void number(const std::string& name, double min, double max, double& value,
              bool inclusive = true);
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
      refusals_.push_back(refusal(name, word, allowed, used));
    }
  }

 private:
  /// Returns true if the parameter is set and has this type.
  template <class T>
  bool read(const std::string& name, const std::string& allowed, const std::string& used,
            T& value) {
    if (nh_.getParam(name, value)) return true;
    refuse_type(name, allowed, used);
    return false;
  }
  void refuse_type(const std::string& name, const std::string& allowed, const std::string& used);
  template <class T>
  void range(const std::string& name, T min, T max, bool inclusive, T& value);

  const ros::NodeHandle& nh_;
  std::vector<std::string>& refusals_;
};

}  // namespace fpga_stereo
