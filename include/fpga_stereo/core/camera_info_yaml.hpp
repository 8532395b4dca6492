// Reads and writes calibrations in camera_info files, the YAML of camera_calibration_parsers and
// cameracalibrator.py.
#pragma once

#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Reads the camera_info file at `path`: at most 64 KiB, without aliases.
///
/// Required keys: image_width, image_height, camera_matrix (3x3), distortion_coefficients (at most
/// 14 values), rectification_matrix (3x3) and projection_matrix (3x4); a matrix has the keys rows,
/// cols and data, row-major. Optional keys: distortion_model (default plumb_bob), binning_x,
/// binning_y and roi (x_offset, y_offset, width, height). Other keys are ignored.
///
/// Checks the format only: validate() and make_stereo_rectification() check what the values mean.
/// The error message names the file, the key, its value and what is allowed.
Result<CameraCalibration> read_camera_info(const std::string& path);

/// Parses the text of a camera_info file; error messages call it `name`.
Result<CameraCalibration> parse_camera_info(const std::string& text, const std::string& name);

/// Returns the text of a camera_info file, for which parse_camera_info() returns exactly `camera`.
/// Refuses a calibration for which that is impossible: a value is not finite, for example.
/// `camera_name` is for people; nothing here reads it.
Result<std::string> format_camera_info(const CameraCalibration& camera,
                                       const std::string& camera_name);

}  // namespace fpga_stereo
