#include "support/stereo_calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <stdexcept>

namespace fpga_stereo::tools {
namespace {

constexpr std::size_t kPlumbBobCoefficients = 5;

/// Reads a matrix; throws unless it has `rows` rows and `cols` columns.
cv::Mat1d read_matrix(const std::string& path, const cv::FileStorage& file, const std::string& name,
                      int rows, int cols) {
  const cv::FileNode node = file[name];
  const cv::Mat1d matrix = node.isMap() ? cv::Mat1d(node.mat()) : cv::Mat1d();
  if (matrix.rows == rows && matrix.cols == cols) return matrix;
  throw std::runtime_error(fmt::format("{}: {} is {}x{}: allowed {}x{}", path, name, matrix.rows,
                                       matrix.cols, rows, cols));
}

cv::FileStorage open_yaml(const std::string& path) {
  cv::FileStorage file;
  try {
    file.open(path, cv::FileStorage::READ);
  } catch (const cv::Exception& e) {
    throw std::runtime_error(fmt::format("{}: is not valid YAML: {}", path, e.err));
  }
  if (!file.isOpened()) throw std::runtime_error(path + ": cannot be read");
  return file;
}

}  // namespace

CameraCalibration make_calibration(cv::Size size, const Intrinsics& camera, const cv::Matx33d& R,
                                   const cv::Matx34d& P) {
  CameraCalibration calibration;
  calibration.width = size.width;
  calibration.height = size.height;
  calibration.distortion_model = "plumb_bob";
  calibration.D = camera.D;
  calibration.D.resize(kPlumbBobCoefficients, 0.0);
  std::copy_n(camera.K.val, calibration.K.size(), calibration.K.begin());
  std::copy_n(R.val, calibration.R.size(), calibration.R.begin());
  std::copy_n(P.val, calibration.P.size(), calibration.P.begin());
  return calibration;
}

StereoCalibration rectified_calibration(cv::Size size, const Intrinsics& left,
                                        const Intrinsics& right, const cv::Matx33d& rotation,
                                        const cv::Vec3d& translation) {
  cv::Mat R1, R2, P1, P2, Q;
  cv::stereoRectify(left.K, left.D, right.K, right.D, size, rotation, translation, R1, R2, P1, P2,
                    Q, cv::CALIB_ZERO_DISPARITY, 0, size);
  return {make_calibration(size, left, R1, P1), make_calibration(size, right, R2, P2)};
}

StereoCalibration read_opencv_calibration(const std::string& folder, cv::Size size) {
  const std::string intrinsics = folder + "/intrinsics.yml",
                    extrinsics = folder + "/extrinsics.yml";
  const cv::FileStorage in = open_yaml(intrinsics), ex = open_yaml(extrinsics);
  const auto camera = [&](const std::string& number) {
    const cv::Mat1d D = read_matrix(intrinsics, in, "D" + number, 1, kPlumbBobCoefficients);
    const Intrinsics found{cv::Matx33d(read_matrix(intrinsics, in, "M" + number, 3, 3)),
                           {D.begin(), D.end()}};
    return make_calibration(size, found,
                            cv::Matx33d(read_matrix(extrinsics, ex, "R" + number, 3, 3)),
                            cv::Matx34d(read_matrix(extrinsics, ex, "P" + number, 3, 4)));
  };
  return {camera("1"), camera("2")};
}

}  // namespace fpga_stereo::tools
