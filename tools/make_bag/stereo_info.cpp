#include "make_bag/stereo_info.hpp"

#include <sensor_msgs/distortion_models.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>

namespace fpga_stereo::tools {
namespace {

constexpr std::size_t kPlumbBobCoefficients = 5;

sensor_msgs::CameraInfo camera_info(cv::Size size, const Intrinsics& camera, const cv::Matx33d& R,
                                    const cv::Matx34d& P) {
  sensor_msgs::CameraInfo info;
  info.width = static_cast<std::uint32_t>(size.width);
  info.height = static_cast<std::uint32_t>(size.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D = camera.D;
  info.D.resize(kPlumbBobCoefficients, 0.0);
  std::copy_n(camera.K.val, info.K.size(), info.K.begin());
  std::copy_n(R.val, info.R.size(), info.R.begin());
  std::copy_n(P.val, info.P.size(), info.P.begin());
  return info;
}

}  // namespace

StereoInfo rectified_info(cv::Size size, double focal, double baseline) {
  const double cx = (size.width - 1) / 2.0;
  const double cy = (size.height - 1) / 2.0;
  const Intrinsics camera{{focal, 0, cx, 0, focal, cy, 0, 0, 1}, {}};
  cv::Matx34d P(focal, 0, cx, 0, 0, focal, cy, 0, 0, 0, 1, 0);
  StereoInfo pair;
  pair.left = camera_info(size, camera, cv::Matx33d::eye(), P);
  P(0, 3) = -focal * baseline;
  pair.right = camera_info(size, camera, cv::Matx33d::eye(), P);
  return pair;
}

StereoInfo calibrated_info(cv::Size size, const Intrinsics& left, const Intrinsics& right,
                           const cv::Matx33d& rotation, const cv::Vec3d& translation) {
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(left.K, left.D, right.K, right.D, size, rotation, translation, R1, R2, P1, P2,
                    Q, cv::CALIB_ZERO_DISPARITY, 0, size);
  return {camera_info(size, left, R1, P1), camera_info(size, right, R2, P2)};
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
