#include "support/stereo_calibration.hpp"

#include <algorithm>
#include <opencv2/calib3d.hpp>

#include "core/yaml_mapping.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {
namespace {

constexpr std::size_t kPlumbBobCoefficients = 5;

std::vector<double> read_matrix(const YamlMapping& file, const std::string& name, int rows,
                                int cols) {
  const auto values = file.matrix(name, rows, cols);
  require(values);
  return *values;
}

YamlMapping read_yaml(const std::string& path) {
  const auto file = YamlMapping::read(path, "a calibration of OpenCV");
  require(file);
  return *file;
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
  const YamlMapping in = read_yaml(folder + "/intrinsics.yml");
  const YamlMapping ex = read_yaml(folder + "/extrinsics.yml");
  const auto camera = [&](const std::string& number) {
    const Intrinsics found{cv::Matx33d(read_matrix(in, "M" + number, 3, 3).data()),
                           read_matrix(in, "D" + number, 1, kPlumbBobCoefficients)};
    return make_calibration(size, found, cv::Matx33d(read_matrix(ex, "R" + number, 3, 3).data()),
                            cv::Matx34d(read_matrix(ex, "P" + number, 3, 4).data()));
  };
  return {camera("1"), camera("2")};
}

}  // namespace fpga_stereo::tools
