#include "fpga_stereo/ros/board_settings.hpp"

#include <map>
#include <sstream>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {
namespace {

template <class T>
std::string refusal(const char* name, const T& value, const std::string& allowed, const T& used) {
  std::ostringstream text;
  text << name << " = " << value << ": allowed " << allowed << "; using " << used;
  return text.str();
}

/// Reads numbers and refuses those out of their range.
class Reader {
 public:
  Reader(const ros::NodeHandle& nh, std::vector<std::string>& refusals)
      : nh_(nh), refusals_(refusals) {}

  template <class T>
  void number(const char* name, T min, T max, T& value) {
    T read = value;
    nh_.param(name, read, value);
    if (read >= min && read <= max) {
      value = read;
      return;
    }
    std::ostringstream allowed;
    allowed << min << " to " << max;
    refusals_.push_back(refusal(name, read, allowed.str(), value));
  }

  template <class T>
  void choice(const char* name, const std::map<std::string, T>& choices, T& value) {
    std::string text;
    if (!nh_.getParam(name, text)) return;
    if (const auto found = choices.find(text); found != choices.end()) {
      value = found->second;
      return;
    }
    std::string allowed, used;
    for (const auto& [word, meaning] : choices) {
      allowed += (allowed.empty() ? "" : " or ") + word;
      if (meaning == value) used = word;
    }
    refusals_.push_back(refusal(name, text, allowed, used));
  }

 private:
  const ros::NodeHandle& nh_;
  std::vector<std::string>& refusals_;
};

/// A serial number may look like a number: 0123 and 12345678 are no integers to their owner.
std::string serial_number(const ros::NodeHandle& nh) {
  XmlRpc::XmlRpcValue value;
  if (!nh.getParam("serial_number", value)) return "";
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt) {
    return std::to_string(static_cast<int&>(value));
  }
  if (value.getType() != XmlRpc::XmlRpcValue::TypeString) return value.toXml();
  return static_cast<std::string&>(value);
}

}  // namespace

BoardSettings load_board_settings(const ros::NodeHandle& private_nh,
                                  std::vector<std::string>& refusals) {
  BoardSettings settings;
  Reader read(private_nh, refusals);
  read.choice<Backend>(
      "backend",
      {{"auto", Backend::kAuto}, {"board", Backend::kBoard}, {"software", Backend::kSoftware}},
      settings.backend);
  read.choice<bool>("board_input", {{"cameras", false}, {"topics", true}}, settings.topic_input);
  private_nh.param("device", settings.device, settings.device);
  if (const std::string serial = serial_number(private_nh); !serial.empty()) {
    settings.device = "usb:serial=" + serial;
  }
  read.number("image_width", kGatewareMinWidth, kGatewareMaxWidth, settings.image_size.width);
  read.number("image_height", 1, kGatewareMaxHeight, settings.image_size.height);
  private_nh.param("frame_id", settings.frame_id, settings.frame_id);
  private_nh.param("left_info_url", settings.left_url, settings.left_url);
  private_nh.param("right_info_url", settings.right_url, settings.right_url);
  read.number("mid_exposure", 0.0, 1000.0, settings.mid_exposure_ms);
  read.number("frame_interval", 1, 1000, settings.frame_interval);
  read.number("verify", 0, 10000, settings.verify);
  private_nh.param("keep_incomplete", settings.keep_incomplete, settings.keep_incomplete);
  return settings;
}

}  // namespace fpga_stereo
