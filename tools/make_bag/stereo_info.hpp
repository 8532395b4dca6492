// Makes the camera_info messages of a stereo pair from what is known about its cameras.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core.hpp>

#include "support/stereo_calibration.hpp"

namespace fpga_stereo::tools {

struct StereoInfo {
  sensor_msgs::CameraInfo left, right;
};

/// Returns the messages of a calibration, without header.
StereoInfo to_info(const StereoCalibration& calibration);

/// Returns the calibration of a pair that is rectified already: no distortion, principal point at
/// the image centre. `focal` is in px, `baseline` in m.
StereoInfo rectified_info(cv::Size size, double focal, double baseline);

/// Rectifies as rectified_calibration() does.
StereoInfo calibrated_info(cv::Size size, const Intrinsics& left, const Intrinsics& right,
                           const cv::Matx33d& rotation, const cv::Vec3d& translation);

/// Adapts the calibration to images that were resized to `size`.
void resize(cv::Size size, sensor_msgs::CameraInfo& info);

}  // namespace fpga_stereo::tools
