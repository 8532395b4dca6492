// make_bag frames: prints the tf frames of a calibrated pair, as a URDF or as a transform.
#include <fmt/format.h>

#include <iostream>
#include <opencv2/core.hpp>
#include <regex>
#include <sstream>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "make_bag/modes.hpp"
#include "ros/calibration_url.hpp"

namespace fpga_stereo::tools {
namespace {

namespace po = boost::program_options;

CommandLine command_line() {
  CommandLine line;
  line.usage =
      "Usage: make_bag frames --left-info LEFT --right-info RIGHT [options]\n"
      "Prints a URDF of the pair, with the baseline of the calibration. NAME_link is in the left\n"
      "camera (x forward, y left, z up); NAME_left_optical_frame and NAME_right_optical_frame are\n"
      "those of the rectified images (z forward, x right, y down).\n";
  line.options.add_options()("left-info", po::value<std::string>()->value_name("FILE")->required(),
                             "calibration of the left camera, a camera_info file or its URL")(
      "right-info", po::value<std::string>()->value_name("FILE")->required(),
      "calibration of the right camera")(
      "camera", po::value<std::string>()->value_name("NAME")->default_value("stereo"),
      "name of the pair, the prefix of its frames")(
      "frame-id", po::value<std::string>()->value_name("FRAME"),
      "left optical frame, if it is not NAME_left_optical_frame")(
      "parent", po::value<std::string>()->value_name("FRAME"),
      "frame that the pair is mounted on, for example base_link; adds a joint from it to "
      "NAME_link")("xyz", po::value<std::string>()->value_name("\"X Y Z\"")->default_value("0 0 0"),
                   "where NAME_link is in the parent frame (m)")(
      "rpy", po::value<std::string>()->value_name("\"R P Y\"")->default_value("0 0 0"),
      "its roll, pitch and yaw there (rad)")(
      "format", po::value<std::string>()->value_name("urdf|transform")->default_value("urdf"),
      "transform: only the transform from the left to the right optical frame, as YAML for\n"
      "tf2_ros static_transform_publisher");
  return line;
}

/// What the output is made of.
struct Frames {
  std::string name, left, right;  // prefix and optical frames
  std::string parent, xyz, rpy;   // no parent: empty
  double baseline = 0;            // m
};

std::string text(const po::variables_map& options, const std::string& option) {
  return options.count(option) == 0 ? "" : options[option].as<std::string>();
}

/// Returns a frame name, which may be empty. Throws UsageError if XML or tf would not take it.
std::string frame_name(const po::variables_map& options, const std::string& option) {
  static const std::regex allowed("[A-Za-z0-9_][A-Za-z0-9_/.-]*");
  const std::string name = text(options, option);
  if (name.empty() || std::regex_match(name, allowed)) return name;
  throw UsageError(fmt::format(
      "--{} \"{}\": allowed are letters, digits, _ and, after the first one, / . -", option, name));
}

/// Returns the text of three numbers. Throws UsageError for any other text.
std::string three_numbers(const po::variables_map& options, const std::string& option) {
  std::istringstream stream(text(options, option));
  cv::Vec3d v;
  std::string rest;
  if (stream >> v[0] >> v[1] >> v[2] && !(stream >> rest)) {
    return fmt::format("{} {} {}", v[0], v[1], v[2]);
  }
  throw UsageError(
      fmt::format("--{} \"{}\": allowed are three numbers", option, text(options, option)));
}

CameraCalibration read(const po::variables_map& options, const std::string& side,
                       const std::string& name) {
  std::string path = text(options, side + "-info");
  if (path.find("://") != std::string::npos) {
    const Result<std::string> resolved = path_of_url(path, name + "_" + side);
    require(resolved);
    path = *resolved;
  }
  const auto calibration = read_camera_info(path);
  require(calibration);
  return *calibration;
}

double baseline(const po::variables_map& options, const std::string& name) {
  const CameraCalibration left = read(options, "left", name), right = read(options, "right", name);
  const auto rectification = make_stereo_rectification(left, right, 0);
  require(rectification);
  return rectification->geometry.baseline;
}

/// Returns a fixed joint and its child link.
std::string joint(const std::string& parent, const std::string& child, const std::string& xyz,
                  const std::string& rpy) {
  return fmt::format(
      "  <joint name=\"{1}_joint\" type=\"fixed\">\n"
      "    <origin xyz=\"{2}\" rpy=\"{3}\" />\n"
      "    <parent link=\"{0}\" />\n"
      "    <child link=\"{1}\" />\n"
      "  </joint>\n"
      "  <link name=\"{1}\" />\n",
      parent, child, xyz, rpy);
}

std::string urdf(const Frames& f) {
  const std::string link = f.name + "_link";
  std::string out = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", f.name);
  if (f.parent.empty()) {
    out += fmt::format("  <link name=\"{}\" />\n", link);
  } else {
    out += fmt::format("  <link name=\"{}\" />\n", f.parent);
    out += joint(f.parent, link, f.xyz, f.rpy);
  }
  out += joint(link, f.left, "0 0 0", "-1.5707963268 0 -1.5707963268");
  out += joint(f.left, f.right, fmt::format("{:.6f} 0 0", f.baseline), "0 0 0");
  return out + "</robot>\n";
}

std::string transform(const Frames& f) {
  return fmt::format(
      "header: {{frame_id: {}}}\n"
      "child_frame_id: {}\n"
      "transform:\n"
      "  translation: {{x: {:.6f}, y: 0.0, z: 0.0}}\n"
      "  rotation: {{x: 0.0, y: 0.0, z: 0.0, w: 1.0}}\n",
      f.left, f.right, f.baseline);
}

}  // namespace

void print_frames(const Arguments& arguments) {
  const auto parsed = parse(command_line(), arguments);
  if (!parsed) return;
  const po::variables_map& options = parsed->options;
  Frames frames;
  frames.name = frame_name(options, "camera");
  if (frames.name.empty()) throw UsageError("--camera is empty");
  frames.left = frame_name(options, "frame-id");
  if (frames.left.empty()) frames.left = frames.name + "_left_optical_frame";
  frames.right = frames.name + "_right_optical_frame";
  frames.parent = frame_name(options, "parent");
  frames.xyz = three_numbers(options, "xyz");
  frames.rpy = three_numbers(options, "rpy");
  const std::string format = text(options, "format");
  if (format != "urdf" && format != "transform") {
    throw UsageError(fmt::format("--format {}: allowed are urdf and transform", format));
  }
  frames.baseline = baseline(options, frames.name);
  std::cout << (format == "urdf" ? urdf(frames) : transform(frames));
}

}  // namespace fpga_stereo::tools
