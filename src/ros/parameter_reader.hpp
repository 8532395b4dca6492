// Parameters that are read once at the start. What is not allowed, or of another type, keeps its
// default and is named: nothing is passed over in silence.
#pragma once

#include <ros/node_handle.h>

#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace fpga_stereo {

/// A parameter as the parameter server has it, as text.
std::string text_of(XmlRpc::XmlRpcValue& value);
/// "1 (a whole number)".
std::string with_type(XmlRpc::XmlRpcValue& value);

/// "name = value: allowed ...; using ...".
std::string refusal(const std::string& name, const std::string& value, const std::string& allowed,
                    const std::string& used);

class ParameterReader {
 public:
  /// Both outlive it.
  ParameterReader(const ros::NodeHandle& nh, std::vector<std::string>& refusals)
      : nh_(nh), refusals_(refusals) {}

  // Each leaves `value` as it is where the parameter is not set, or refused. A whole number is a
  // number, too.
  void number(const std::string& name, int min, int max, int& value);
  /// More than `above`, or at least that where `inclusive`.
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
  /// Whether the parameter is set, and of this type.
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
