// What the benchmark compares: from the same raw pair to a filtered disparity, each in its own way.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo::bench {

/// A raw pair and its calibration: a real one where the test data is there, scaled to `size`; else
/// of random texture.
struct Scene {
  cv::Mat1b left, right;
  CameraCalibration left_camera, right_camera;
  bool real = false;
};
Scene make_scene(cv::Size size);

/// Computes the disparity of the scene once. ms: of the stages, where the contender knows them.
using Contender = std::function<void(StageTimes& ms)>;

/// Names: fpga_stereo/sparse, fpga_stereo/full, fpga_stereo/sparse_scalar, opencv/StereoBM,
/// opencv/StereoSGBM, opencv/StereoSGBM_3WAY.
const std::vector<std::string>& contender_names();
Contender make_contender(const std::string& name, const Scene& scene, int disparities, int threads);

}  // namespace fpga_stereo::bench
