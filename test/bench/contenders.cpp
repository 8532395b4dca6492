#include "bench/contenders.hpp"

#include <algorithm>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/core/target.hpp"
#include "support/data.hpp"
#include "support/images.hpp"
#include "support/opencv_matcher.hpp"

namespace fpga_stereo::bench {
namespace {

CameraCalibration scaled(CameraCalibration camera, cv::Size size) {
  const double x = static_cast<double>(size.width) / camera.width;
  const double y = static_cast<double>(size.height) / camera.height;
  // The rectified focal lengths of both axes have to agree with those of the raw image only.
  for (const std::size_t i : {0U, 1U, 2U}) camera.K[i] *= x;
  for (const std::size_t i : {3U, 4U, 5U}) camera.K[i] *= y;
  for (const std::size_t i : {0U, 1U, 2U, 3U}) camera.P[i] *= x;
  for (const std::size_t i : {4U, 5U, 6U, 7U}) camera.P[i] *= y;
  camera.width = size.width;
  camera.height = size.height;
  return camera;
}

CameraCalibration textured_camera(cv::Size size, double shift) {
  CameraCalibration camera;
  camera.width = size.width;
  camera.height = size.height;
  camera.distortion_model = "plumb_bob";
  camera.D = {-0.28, 0.07, 0.0002, 0.00002, 0};
  const double f = 0.7 * size.width, cx = size.width / 2.0, cy = size.height / 2.0;
  camera.K = {f, 0, cx, 0, f, cy, 0, 0, 1};
  camera.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  camera.P = {f, 0, cx, shift, 0, f, cy, 0, 0, 0, 1, 0};
  return camera;
}

cv::Mat matrix(const double* values, int rows, int cols) {
  return cv::Mat(rows, cols, CV_64F, const_cast<double*>(values)).clone();
}

/// cv::remap with fixed-point maps, as image_geometry computes them.
class Remap {
 public:
  explicit Remap(const CameraCalibration& c) {
    cv::initUndistortRectifyMap(matrix(c.K.data(), 3, 3), c.D, matrix(c.R.data(), 3, 3),
                                matrix(c.P.data(), 3, 4), {c.width, c.height}, CV_16SC2, position_,
                                weight_);
  }
  const cv::Mat1b& operator()(const cv::Mat1b& raw) {
    cv::remap(raw, out_, position_, weight_, cv::INTER_LINEAR);
    return out_;
  }

 private:
  cv::Mat position_, weight_;
  cv::Mat1b out_;
};

Contender make_opencv(const std::string& name, const Scene& scene, int disparities) {
  struct State {
    Remap left, right;
    cv::Ptr<cv::StereoMatcher> matcher;
    cv::Mat disparity;
  };
  const auto matcher =
      std::find_if(tools::kOpencvMatchers.begin(), tools::kOpencvMatchers.end(),
                   [&](tools::OpencvMatcher each) { return name == tools::to_text(each); });
  if (matcher == tools::kOpencvMatchers.end()) throw std::runtime_error(name + ": unknown");
  const auto state =
      std::make_shared<State>(State{Remap(scene.left_camera),
                                    Remap(scene.right_camera),
                                    tools::make_opencv_matcher(*matcher, disparities),
                                    {}});
  return [state, &scene](StageTimes&) {
    state->matcher->compute(state->left(scene.left), state->right(scene.right), state->disparity);
  };
}

/// Returns the parameters of sgm, sgm_small, sgm_dense, sparse, full or sparse_scalar.
Parameters parameters_of(const std::string& name) {
  const bool is_sgm = name.rfind("sgm", 0) == 0;
  Parameters p = is_sgm ? Parameters() : window_parameters();
  if (name == "sgm_small") p.sgm_build = SgmBuild::kSmall;
  p.dense = name == "sgm_dense";
  if (name == "full") p.census_pattern = CensusPattern::kFull;
  return p;
}

Contender make_ours(const std::string& name, const Scene& scene, int disparities, int threads) {
  struct State {
    Pipeline pipeline;
    StereoRectification rectification;
    Parameters parameters;
  };
  const auto rectification = make_stereo_rectification(scene.left_camera, scene.right_camera, 0);
  if (!rectification) throw std::runtime_error(rectification.error().message);
  const auto state = std::make_shared<State>();
  state->rectification = *rectification;
  state->parameters = parameters_of(name);
  state->parameters.disparity_range = disparities;
  return [state, &scene, threads, scalar = name == "sparse_scalar"](StageTimes& ms) {
    const std::string before = target();
    if (scalar) (void)choose_target(kScalarTarget);
    ms = state->pipeline
             .process(scene.left, scene.right, state->rectification, state->parameters, threads)
             .ms;
    if (scalar) (void)choose_target(before);
  };
}

}  // namespace

Scene make_scene(cv::Size size) {
  Scene scene;
  scene.is_real = test::data_dir().has_value();
  if (scene.is_real) {
    const test::ImagePair pair = test::euroc_pair(0);
    const test::CalibrationPair cameras = test::euroc_calibration();
    cv::resize(pair.left, scene.left, size, 0, 0, cv::INTER_AREA);
    cv::resize(pair.right, scene.right, size, 0, 0, cv::INTER_AREA);
    scene.left_camera = scaled(cameras.left, size);
    scene.right_camera = scaled(cameras.right, size);
  } else {
    const test::SlantedPair pair = test::slanted_pair(size, test::Texture(1), 5, 0.05);
    scene.left = pair.left;
    scene.right = pair.right;
    scene.left_camera = textured_camera(size, 0);
    scene.right_camera = textured_camera(size, -0.07 * size.width);
  }
  return scene;
}

const std::vector<std::string>& contender_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all{"fpga_stereo/sgm",       "fpga_stereo/sgm_small",
                                 "fpga_stereo/sgm_dense", "fpga_stereo/sparse",
                                 "fpga_stereo/full",      "fpga_stereo/sparse_scalar"};
    for (const tools::OpencvMatcher matcher : tools::kOpencvMatchers) {
      all.push_back(std::string("opencv/") + tools::to_text(matcher));
    }
    return all;
  }();
  return names;
}

Contender make_contender(const std::string& name, const Scene& scene, int disparities,
                         int threads) {
  const std::size_t slash = name.find('/');
  const std::string what = name.substr(slash + 1);
  if (name.substr(0, slash) == "opencv") return make_opencv(what, scene, disparities);
  return make_ours(what, scene, disparities, threads);
}

}  // namespace fpga_stereo::bench
