// Finds and reads the calibration files that parameters name by URL.
#pragma once

#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Where the calibration files of a pair are.
struct CalibrationUrls {
  std::string left, right;
};

/// Returns a name that is unique for the pair on its robot: its namespace with _ for /, and a final
/// _ unless it is empty. Calibrations are stored under this name and that of the side.
std::string calibration_prefix(const std::string& pair_namespace);

/// Returns the path that a URL names, as those of camera_info_manager do: file:///...,
/// package://PACKAGE/..., or an absolute path. ${NAME} stands for `name`, ${ROS_HOME} for that
/// directory. The error message says which URLs are allowed.
Result<std::string> path_of_url(const std::string& url, const std::string& name);

/// Reads the camera_info file (YAML) that the URL names.
Result<CameraCalibration> read_calibration_url(const std::string& url, const std::string& name);

}  // namespace fpga_stereo
