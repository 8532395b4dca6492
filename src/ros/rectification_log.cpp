#include "ros/rectification_log.hpp"

#include <ros/console.h>

namespace fpga_stereo {

void log_rectification(const StereoRectification& rectification) {
  const StereoGeometry& g = rectification.geometry;
  ROS_INFO_NAMED(
      "stereo",
      "new rectification: %dx%d, f %.2f px, baseline %.4f m; the meshes deviate from the "
      "exact map by at most %.4f px (left) and %.4f px (right)",
      g.image_size.width, g.image_size.height, g.fx, g.baseline, rectification.left.deviation.max,
      rectification.right.deviation.max);
  if (g.cx != g.cx_right) {
    ROS_WARN_NAMED(
        "stereo",
        "cx of the left and right camera_info P differ by %.3f px: the node subtracts the "
        "difference from the disparity once, as DisparityImage defines; "
        "stereo_image_proc would compute a wrong depth from this calibration",
        g.cx - g.cx_right);
  }
}

}  // namespace fpga_stereo
