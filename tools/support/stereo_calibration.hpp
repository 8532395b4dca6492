// Calibrations of a camera pair from what a calibration program finds.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo::tools {

/// The parameters of one camera before rectification.
struct Intrinsics {
  cv::Matx33d K;          // px
  std::vector<double> D;  // plumb_bob: k1 k2 t1 t2 [k3]
};

/// Returns a calibration with the model plumb_bob.
CameraCalibration make_calibration(cv::Size size, const Intrinsics& camera, const cv::Matx33d& R,
                                   const cv::Matx34d& P);

/// Rectifies with cv::stereoRectify (zero disparity at infinity, alpha 0: no black border).
/// `rotation` and `translation` (m) transform points from the left to the right camera frame.
StereoCalibration rectified_calibration(cv::Size size, const Intrinsics& left,
                                        const Intrinsics& right, const cv::Matx33d& rotation,
                                        const cv::Vec3d& translation);

/// Reads intrinsics.yml (M1, D1, M2, D2) and extrinsics.yml (R1, P1, R2, P2) of a folder, as the
/// sample stereo_calib of OpenCV writes them, for images of this size. Throws std::runtime_error
/// with the file that cannot be used.
StereoCalibration read_opencv_calibration(const std::string& folder, cv::Size size);

}  // namespace fpga_stereo::tools
