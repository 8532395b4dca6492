#include "ros/board_settings.hpp"

#include <fmt/format.h>

#include "fpga_stereo/core/spec.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo {
namespace {

/// Returns the frame of the left camera by the name of the pair: the last word of the namespace
/// that the node is in.
std::string default_frame_id(const ros::NodeHandle& private_nh) {
  std::string pair = private_nh.getNamespace();
  pair.erase(pair.rfind('/'));  // the name of the node
  pair.erase(0, pair.rfind('/') + 1);
  return (pair.empty() ? "stereo" : pair) + "_left_optical_frame";
}

/// Selects the device by ~serial_number if that is set.
void read_serial_number(const ros::NodeHandle& nh, ParameterReport& report, std::string& device) {
  report.names.insert("serial_number");
  XmlRpc::XmlRpcValue value;
  if (!nh.getParam("serial_number", value)) return;
  const std::string text = text_of(value);
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt) {
    // The parameter server turns 0012 into 12: leading zeros do not count.
    device = "usb:match=^0*" + text + "$";
    return;
  }
  if (value.getType() != XmlRpc::XmlRpcValue::TypeString) {
    report.errors.push_back(refusal("serial_number", with_type(value), "text: quote it", text));
  }
  if (!text.empty()) device = "usb:serial=" + text;
}

void read_device(const ros::NodeHandle& nh, ParameterReport& report, std::string& device) {
  report.names.insert("device");
  XmlRpc::XmlRpcValue value;
  if (nh.getParam("device", value)) {
    device = text_of(value);
    if (const Status status = link::check_transport_name(device); !status) {
      report.errors.push_back(
          fmt::format("device: {}; the node opens no board", status.error().message));
    }
  }
  read_serial_number(nh, report, device);
}

}  // namespace

bool is_recording(const BoardSettings& settings) {
  return settings.device.rfind("replay:", 0) == 0;
}

BoardSettings load_board_settings(const ros::NodeHandle& private_nh, ParameterReport& report) {
  BoardSettings settings;
  ParameterReader read(private_nh, report);
  read.choice<Backend>(
      "backend",
      {{"auto", Backend::kAuto}, {"board", Backend::kBoard}, {"software", Backend::kSoftware}},
      settings.backend);
  read.choice<bool>("board_input", {{"cameras", false}, {"topics", true}}, settings.topic_input);
  read_device(private_nh, report, settings.device);
  if (is_recording(settings) && settings.topic_input) {
    report.errors.push_back(
        refusal("board_input", "topics", "cameras, because device is a recording", "cameras"));
    settings.topic_input = false;
  }
  read.number("image_width", kGatewareMinWidth, kGatewareMaxWidth, settings.image_size.width);
  read.number("image_height", 1, kGatewareMaxHeight, settings.image_size.height);
  settings.frame_id = default_frame_id(private_nh);
  read.text("frame_id", settings.frame_id);
  read.text("left_info_url", settings.left_url);
  read.text("right_info_url", settings.right_url);
  read.number("mid_exposure", 0.0, 1000.0, settings.mid_exposure_ms);
  read.number("frame_interval", 1, 1000, settings.frame_interval);
  read.number("verify", 0, 10000, settings.verify);
  read.flag("keep_incomplete", settings.keep_incomplete);
  return settings;
}

}  // namespace fpga_stereo
