// Makes the camera_info messages of a stereo pair from what is known about its cameras.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core.hpp>
#include <vector>

namespace fpga_stereo::tools {

struct StereoInfo {
  sensor_msgs::CameraInfo left, right;
};

/// The parameters of one camera before rectification.
struct Intrinsics {
  cv::Matx33d K;          // px
  std::vector<double> D;  // plumb_bob: k1 k2 t1 t2 [k3]
};

/// Returns the calibration of a pair that is rectified already: no distortion, principal point at
/// the image centre. `focal` is in px, `baseline` in m.
StereoInfo rectified_info(cv::Size size, double focal, double baseline);

/// Rectifies with cv::stereoRectify (zero disparity at infinity, alpha 0: no black border).
/// `rotation` and `translation` (m) transform points from the left to the right camera frame.
StereoInfo calibrated_info(cv::Size size, const Intrinsics& left, const Intrinsics& right,
                           const cv::Matx33d& rotation, const cv::Vec3d& translation);

/// Adapts the calibration to images that were resized to `size`.
void resize(cv::Size size, sensor_msgs::CameraInfo& info);

}  // namespace fpga_stereo::tools
