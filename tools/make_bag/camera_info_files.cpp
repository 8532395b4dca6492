#include "make_bag/camera_info_files.hpp"

#include "core/pending_file.hpp"
#include "fpga_stereo/core/camera_info_yaml.hpp"
#include "ros/conversions.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {

sensor_msgs::CameraInfo read_camera_info_message(const std::string& path) {
  const auto camera = read_camera_info(path);
  require(camera);
  return to_camera_info(*camera, {});
}

void write_camera_info(const std::string& path, const std::string& camera,
                       const sensor_msgs::CameraInfo& info) {
  const auto calibration = to_calibration(info, camera);
  require(calibration, path + ": ");
  const auto text = format_camera_info(*calibration, camera);
  require(text, path + ": ");
  auto file = PendingFile::write(path, *text);
  require(file);
  require((*file).commit());
}

}  // namespace fpga_stereo::tools
