#include "make_bag/camera_info_files.hpp"

#include <camera_calibration_parsers/parse.h>
#include <fmt/format.h>

#include <stdexcept>

#include "support/files.hpp"

namespace fpga_stereo::tools {

sensor_msgs::CameraInfo read_camera_info_message(const std::string& path) {
  require_readable(path);  // the parser does not say why it cannot read a file
  std::string camera;
  sensor_msgs::CameraInfo info;
  bool is_read = false;
  try {
    is_read = camera_calibration_parsers::readCalibration(path, camera, info);
  } catch (const std::exception&) {
    // The parser lets exceptions of its YAML library through.
  }
  if (!is_read) {
    throw std::runtime_error(fmt::format(
        "{}: is not a camera_info file: allowed are .yaml, .yml and .ini files in the format of "
        "camera_calibration_parsers",
        path));
  }
  return info;
}

void write_camera_info(const std::string& path, const std::string& camera,
                       const sensor_msgs::CameraInfo& info) {
  if (!camera_calibration_parsers::writeCalibration(path, camera, info)) {
    throw std::runtime_error(fmt::format("{}: cannot be written", path));
  }
}

}  // namespace fpga_stereo::tools
