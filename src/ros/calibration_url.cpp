#include "ros/calibration_url.hpp"

#include <fmt/format.h>
#include <ros/package.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

#include "core/printable.hpp"
#include "fpga_stereo/core/camera_info_yaml.hpp"

namespace fpga_stereo {
namespace {

constexpr const char* kPackageScheme = "package://";

std::string environment(const char* variable) {
  const char* value = std::getenv(variable);
  return value == nullptr ? "" : value;
}

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
}

bool take_prefix(std::string& text, const std::string& prefix) {
  if (text.rfind(prefix, 0) != 0) return false;
  text.erase(0, prefix.size());
  return true;
}

bool is_package_name(const std::string& text) {
  if (text.empty() || std::isalpha(static_cast<unsigned char>(text[0])) == 0) return false;
  return std::all_of(text.begin(), text.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
}

}  // namespace

std::string calibration_prefix(const std::string& pair_namespace) {
  std::string prefix = pair_namespace;
  prefix.erase(0, prefix.find_first_not_of('/'));
  for (char& c : prefix) c = c == '/' ? '_' : c;
  return prefix.empty() ? prefix : prefix + "_";
}

Result<std::string> path_of_url(const std::string& url, const std::string& name) {
  std::string path = url;
  const std::string ros_home = environment("ROS_HOME");
  replace_all(path, "${ROS_HOME}", ros_home.empty() ? environment("HOME") + "/.ros" : ros_home);
  replace_all(path, "${NAME}", name);
  take_prefix(path, "file://");
  if (take_prefix(path, kPackageScheme)) {
    const std::size_t end = path.find('/');
    const std::string package = path.substr(0, end);
    // The name becomes a part of rospack's command line.
    const std::string folder = is_package_name(package) ? ros::package::getPath(package) : "";
    if (end == std::string::npos || folder.empty()) {
      return Error{ErrorKind::kInvalid,
                   fmt::format("{}: there is no package {}", printable(url), printable(package))};
    }
    return folder + path.substr(end);
  }
  if (path.empty() || path[0] != '/') {
    return Error{ErrorKind::kInvalid,
                 fmt::format("{}: allowed are file:///PATH, package://PACKAGE/PATH and absolute "
                             "paths",
                             printable(url))};
  }
  return path;
}

Result<CameraCalibration> read_calibration_url(const std::string& url, const std::string& name) {
  const Result<std::string> path = path_of_url(url, name);
  if (!path) return path.error();
  return read_camera_info(*path);
}

}  // namespace fpga_stereo
