// The contenders of the benchmark. Each computes a filtered disparity image from the same raw pair.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo::bench {

/// A raw pair and its calibration.
struct Scene {
  cv::Mat1b left, right;
  CameraCalibration left_camera, right_camera;
  bool is_real = false;
};
/// Returns a real pair scaled to `size`, or a random texture if the test data is missing.
Scene make_scene(cv::Size size);

/// Computes the disparity image of the scene once. Sets `ms` if the contender measures stages.
using Contender = std::function<void(StageTimes& ms)>;

/// Returns the names: fpga_stereo/sgm, sgm_small, sgm_dense, and with window matching
/// fpga_stereo/sparse, full, sparse_scalar; opencv/StereoBM, StereoSGBM, StereoSGBM_3WAY,
/// StereoSGBM_HH.
const std::vector<std::string>& contender_names();
Contender make_contender(const std::string& name, const Scene& scene, int disparities, int threads);

}  // namespace fpga_stereo::bench
