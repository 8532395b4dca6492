// camera_info of a stereo pair from what is known about its cameras.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core.hpp>

namespace fpga_stereo::tools {

struct StereoInfo {
  sensor_msgs::CameraInfo left, right;
};

/// A camera as a calibration gives it.
struct Intrinsics {
  cv::Matx33d K;
  std::vector<double> D;  // k1 k2 t1 t2 [k3]
};

/// A pair that is rectified already: no distortion, principal point at the centre of the image.
/// `focal` in px, `baseline` in metres.
StereoInfo rectified_info(cv::Size size, double focal, double baseline);

/// Rectified by cv::stereoRectify (zero disparity, alpha 0: no black border). `rotation` and
/// `translation`, in metres, take points from the left to the right camera.
StereoInfo calibrated_info(cv::Size size, const Intrinsics& left, const Intrinsics& right,
                           const cv::Matx33d& rotation, const cv::Vec3d& translation);

/// The calibration of the same camera after its images were resized to `size`.
void resize(cv::Size size, sensor_msgs::CameraInfo& info);

}  // namespace fpga_stereo::tools
