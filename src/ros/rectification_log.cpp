#include "ros/rectification_log.hpp"

#include <fmt/format.h>
#include <ros/console.h>

#include <utility>

namespace fpga_stereo {

void RectificationLog::note(const StereoRectification& rectification) {
  if (std::exchange(last_, &rectification) == &rectification) return;
  const StereoGeometry& g = rectification.geometry;
  if (const auto kept_back = limiter_.admit("new")) {
    const std::string line = fmt::format(
        "new rectification: {}x{}, f {:.2f} px, baseline {:.4f} m; the meshes deviate from the "
        "exact map by at most {:.4f} px (left) and {:.4f} px (right)",
        g.image_size.width, g.image_size.height, g.fx, g.baseline, rectification.left.deviation.max,
        rectification.right.deviation.max);
    ROS_INFO_STREAM_NAMED("stereo", with_kept_back(line, *kept_back));
  }
  if (g.cx == g.cx_right) return;
  if (const auto kept_back = limiter_.admit("principal points")) {
    const std::string line = fmt::format(
        "cx of the left and right camera_info P differ by {:.3f} px: the node subtracts the "
        "difference from the disparity once, as DisparityImage defines; stereo_image_proc would "
        "compute a wrong depth from this calibration",
        g.cx - g.cx_right);
    ROS_WARN_STREAM_NAMED("stereo", with_kept_back(line, *kept_back));
  }
}

}  // namespace fpga_stereo
