#include "ros/rectifier.hpp"

#include <ros/console.h>

#include <utility>

#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

void report(const StereoRectification& made) {
  const StereoGeometry& g = made.geometry;
  ROS_INFO_NAMED("stereo",
                 "rectification made: %dx%d, f %.2f px, baseline %.4f m; mesh at most %.4f px "
                 "(left) and %.4f px (right) off the exact map",
                 g.image_size.width, g.image_size.height, g.fx, g.baseline, made.left.deviation.max,
                 made.right.deviation.max);
  if (g.cx != g.cx_right) {
    ROS_WARN_NAMED("stereo",
                   "cx of left and right camera_info P differ by %.3f px: it is subtracted from "
                   "the disparity once; stereo_image_proc gives a wrong depth for such a pair",
                   g.cx - g.cx_right);
  }
}

}  // namespace

const Rectifier::Made& Rectifier::operator()(const sensor_msgs::CameraInfo& left_info,
                                             const sensor_msgs::CameraInfo& right_info,
                                             int min_disparity) {
  CameraCalibration left = to_calibration(left_info);
  CameraCalibration right = to_calibration(right_info);
  if (made_ && min_disparity_ == min_disparity && left == left_ && right == right_) return *made_;

  left_ = std::move(left);
  right_ = std::move(right);
  min_disparity_ = min_disparity;
  auto made = make_stereo_rectification(left_, right_, min_disparity);
  if (made) {
    report(*made);
    made_ = std::make_unique<Made>(std::make_shared<const StereoRectification>(std::move(*made)));
  } else {
    made_ = std::make_unique<Made>(made.error());
  }
  return *made_;
}

}  // namespace fpga_stereo
