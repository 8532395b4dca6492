#include "ros/parameter_reader.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace fpga_stereo {
namespace {

using V = XmlRpc::XmlRpcValue;

template <class T>
std::string as_text(const T& value) {
  std::ostringstream stream;
  stream << std::boolalpha << value;
  return stream.str();
}

const char* type_of(const V& value) {
  switch (value.getType()) {
    case V::TypeBoolean:
      return "true or false";
    case V::TypeInt:
      return "a whole number";
    case V::TypeDouble:
      return "a number";
    case V::TypeString:
      return "text";
    default:
      return "not a single value";
  }
}

}  // namespace

std::string text_of(V& value) {
  if (value.getType() == V::TypeBoolean) return as_text(static_cast<bool&>(value));
  if (value.getType() == V::TypeInt) return as_text(static_cast<int&>(value));
  if (value.getType() == V::TypeDouble) return as_text(static_cast<double&>(value));
  if (value.getType() == V::TypeString) return static_cast<std::string&>(value);
  return value.toXml();
}

std::string with_type(V& value) { return text_of(value) + " (" + type_of(value) + ")"; }

std::string refusal(const std::string& name, const std::string& value, const std::string& allowed,
                    const std::string& used) {
  return name + " = " + value + ": allowed " + allowed + "; using " + used;
}

void ParameterReader::refuse_type(const std::string& name, const std::string& allowed,
                                  const std::string& used) {
  V value;
  if (!nh_.getParam(name, value)) return;  // not set
  report_.errors.push_back(refusal(name, with_type(value), allowed, used));
}

template <class T>
void ParameterReader::range(const std::string& name, T min, T max, T& value) {
  const std::string allowed = as_text(min) + " to " + as_text(max);
  T number = value;
  if (!read(name, allowed, as_text(value), number)) return;
  if (std::isnan(static_cast<double>(number))) {
    report_.errors.push_back(refusal(name, as_text(number), allowed, as_text(value)));
    return;
  }
  value = std::clamp(number, min, max);
  if (value == number) return;
  report_.warnings.push_back(refusal(name, as_text(number), allowed, as_text(value)));
}

void ParameterReader::number(const std::string& name, int min, int max, int& value) {
  range(name, min, max, value);
}

void ParameterReader::number(const std::string& name, double min, double max, double& value) {
  range(name, min, max, value);
}

void ParameterReader::positive_number(const std::string& name, double max, double& value) {
  const std::string allowed = "more than 0 to " + as_text(max);
  double number = value;
  if (!read(name, allowed, as_text(value), number)) return;
  if (number > max) {
    value = max;
    report_.warnings.push_back(refusal(name, as_text(number), allowed, as_text(value)));
  } else if (number > 0) {
    value = number;
  } else {
    report_.errors.push_back(refusal(name, as_text(number), allowed, as_text(value)));
  }
}

void ParameterReader::flag(const std::string& name, bool& value) {
  bool flag = value;
  if (read(name, "true or false", as_text(value), flag)) value = flag;
}

void ParameterReader::text(const std::string& name, std::string& value) {
  std::string text = value;
  if (read(name, "text", value.empty() ? "none" : value, text)) value = text;
}

}  // namespace fpga_stereo
