#include "make_bag/stereo_info.hpp"

#include "ros/conversions.hpp"

namespace fpga_stereo::tools {
StereoInfo rectified_info(cv::Size size, double focal, double baseline) {
  const double cx = (size.width - 1) / 2.0;
  const double cy = (size.height - 1) / 2.0;
  const Intrinsics camera{{focal, 0, cx, 0, focal, cy, 0, 0, 1}, {}};
  cv::Matx34d P(focal, 0, cx, 0, 0, focal, cy, 0, 0, 0, 1, 0);
  StereoCalibration pair;
  pair.left = make_calibration(size, camera, cv::Matx33d::eye(), P);
  P(0, 3) = -focal * baseline;
  pair.right = make_calibration(size, camera, cv::Matx33d::eye(), P);
  return to_info(pair);
}

StereoInfo to_info(const StereoCalibration& calibration) {
  return {to_camera_info(calibration.left, {}), to_camera_info(calibration.right, {})};
}

StereoInfo calibrated_info(cv::Size size, const Intrinsics& left, const Intrinsics& right,
                           const cv::Matx33d& rotation, const cv::Vec3d& translation) {
  return to_info(rectified_calibration(size, left, right, rotation, translation));
}

void resize(cv::Size size, sensor_msgs::CameraInfo& info) {
  const double x = static_cast<double>(size.width) / info.width;
  const double y = static_cast<double>(size.height) / info.height;
  // Pixel centres have integer coordinates, so the corner of the image is at -0.5.
  const auto centre = [](double c, double factor) { return (c + 0.5) * factor - 0.5; };
  info.K[0] *= x;
  info.K[1] *= x;
  info.K[2] = centre(info.K[2], x);
  info.K[4] *= y;
  info.K[5] = centre(info.K[5], y);
  info.P[0] *= x;
  info.P[1] *= x;
  info.P[2] = centre(info.P[2], x);
  info.P[3] *= x;
  info.P[5] *= y;
  info.P[6] = centre(info.P[6], y);
  info.P[7] *= y;
  info.width = static_cast<std::uint32_t>(size.width);
  info.height = static_cast<std::uint32_t>(size.height);
}

}  // namespace fpga_stereo::tools
