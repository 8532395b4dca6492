// camera_info files as messages, for programs that put them into bags. Programs without ROS use
// core's read_camera_info().
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <string>

namespace fpga_stereo::tools {

/// Reads a camera_info file. Throws std::runtime_error.
sensor_msgs::CameraInfo read_camera_info_message(const std::string& path);

/// Writes a camera_info file, in which `camera` names the camera. Throws std::runtime_error; then a
/// file that existed is unchanged.
void write_camera_info(const std::string& path, const std::string& camera,
                       const sensor_msgs::CameraInfo& info);

}  // namespace fpga_stereo::tools
