// The meshes of a calibrated pair, made anew only when the calibration changes.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <memory>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

class Rectifier {
 public:
  using Made = Result<std::shared_ptr<const StereoRectification>>;

  /// What the camera_info messages of a pair say, or why nothing can be made of them.
  const Made& operator()(const sensor_msgs::CameraInfo& left, const sensor_msgs::CameraInfo& right,
                         int min_disparity);

 private:
  CameraCalibration left_, right_;
  int min_disparity_ = 0;
  std::unique_ptr<Made> made_;
};

}  // namespace fpga_stereo
