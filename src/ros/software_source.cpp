#include "fpga_stereo/ros/software_source.hpp"

#include <ros/console.h>

#include <utility>

#include "fpga_stereo/ros/conversions.hpp"

namespace fpga_stereo {

SoftwareSource::SoftwareSource(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh,
                               const SyncSettings& sync, Health& health, Callback callback)
    : health_(health),
      callback_(std::move(callback)),
      input_(nh, private_nh, sync, health, [this](const InputPair& pair) { receive(pair); }),
      thread_([this] { run(); }) {}

SoftwareSource::~SoftwareSource() {
  input_.stop();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void SoftwareSource::listen(bool wanted) {
  if (wanted) {
    input_.start();
    return;
  }
  input_.stop();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (waiting_) health_.dropped(DropCause::kUnwanted);
  waiting_.reset();
}

void SoftwareSource::set_demand(const Demand& demand) {
  const std::lock_guard<std::mutex> lock(mutex_);
  demand_ = demand;
}

void SoftwareSource::set_settings(const Settings& settings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  settings_ = settings;
}

void SoftwareSource::receive(const InputPair& pair) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_) health_.dropped(DropCause::kReplaced);
    waiting_ = pair;
  }
  wake_.notify_one();
}

void SoftwareSource::run() {
  while (true) {
    InputPair pair;
    Demand demand;
    Settings settings;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
      if (stopping_) return;
      pair = std::move(*waiting_);
      waiting_.reset();
      demand = demand_;
      settings = settings_;
    }
    if (const auto why = gate_.check(pair.left->header.stamp)) {
      refuse(DropCause::kStamp, "frame refused: " + *why);
    } else if (!demand.any()) {
      health_.dropped(DropCause::kUnwanted);
    } else if (const Result<StereoFrame> frame = make(pair, demand, settings); frame) {
      callback_(*frame);
    } else {
      refuse(cause_of(frame.error().kind), frame.error().message);
    }
  }
}

void SoftwareSource::refuse(DropCause cause, const std::string& why) {
  // Once per reason, not once per frame.
  if (health_.refusal() != why) ROS_ERROR_STREAM_NAMED("stereo", why);
  health_.refused(cause, why);
}

const Result<StereoRectification>& SoftwareSource::rectification(const InputPair& pair,
                                                                 int min_disparity) {
  CameraCalibration left = to_calibration(*pair.left_info);
  CameraCalibration right = to_calibration(*pair.right_info);
  const bool known = rectification_ && rectified_min_disparity_ == min_disparity &&
                     left == left_calibration_ && right == right_calibration_;
  if (known) return *rectification_;

  left_calibration_ = std::move(left);
  right_calibration_ = std::move(right);
  rectified_min_disparity_ = min_disparity;
  rectification_ = std::make_unique<Result<StereoRectification>>(
      make_stereo_rectification(left_calibration_, right_calibration_, min_disparity));
  if (*rectification_) {
    const StereoRectification& made = **rectification_;
    const StereoGeometry& g = made.geometry;
    ROS_INFO_NAMED("stereo",
                   "rectification made: %dx%d, f %.2f px, baseline %.4f m; mesh at most %.4f px "
                   "(left) and %.4f px (right) off the exact map",
                   g.image_size.width, g.image_size.height, g.fx, g.baseline,
                   made.left.deviation.largest, made.right.deviation.largest);
    if (g.cx != g.cx_right) {
      ROS_WARN_NAMED("stereo",
                     "cx of left and right camera_info P differ by %.3f px: it is subtracted from "
                     "the disparity once; stereo_image_proc gives a wrong depth for such a pair",
                     g.cx - g.cx_right);
    }
  }
  return *rectification_;
}

Result<StereoFrame> SoftwareSource::make(const InputPair& pair, const Demand& demand,
                                         const Settings& settings) {
  const Parameters& parameters = settings.pipeline;
  const auto& made = rectification(pair, parameters.min_disparity);
  if (!made) return made.error();
  const StereoRectification& meshes = *made;

  StereoFrame frame;
  frame.header = pair.left->header;
  frame.right_header = pair.right->header;
  frame.right_header.stamp = frame.header.stamp;
  frame.left_info = *pair.left_info;
  frame.geometry = meshes.geometry;
  frame.settings = settings;

  const auto left = to_grey(pair.left, "left");
  if (!left) return left.error();
  const auto right = to_grey(pair.right, "right");
  if (!right) return right.error();
  if (Status s = validate_image(*left, meshes, "left"); !s) return s.error();
  if (Status s = validate_image(*right, meshes, "right"); !s) return s.error();

  const int threads = settings.num_threads;
  if (demand.disparity) {
    const Taps& taps = pipeline_.process(*left, *right, meshes, parameters, threads);
    frame.disparity = taps.disparity;
    frame.left_rect = taps.left;
    if (parameters.min_disparity == 0) frame.right_rect = taps.right;
    frame.ms = taps.ms;
  }
  // What the pipeline has not made on its way.
  const auto rectified = [&](bool wanted, const cv::Mat& raw, const Mesh& mesh, cv::Mat& out) {
    if (wanted && out.empty()) rectify_in_bands(raw, mesh, threads, out);
  };
  rectified(demand.left_rect, *left, meshes.left.mesh, frame.left_rect);
  rectified(demand.right_rect, *right, meshes.right_unshifted, frame.right_rect);

  const auto colored = [&](bool wanted, const sensor_msgs::ImageConstPtr& image,
                           const std::string& name, const Mesh& mesh, const cv::Mat& grey,
                           cv::Mat& out) -> std::optional<Error> {
    if (!wanted) return std::nullopt;
    const auto color = to_bgr(image, name);
    if (!color) return color.error();
    // A grey camera's picture in colour is its grey picture.
    if (color->channels() == 1 && !grey.empty()) {
      out = grey;
    } else {
      rectify_in_bands(*color, mesh, threads, out);
    }
    return std::nullopt;
  };
  if (auto e = colored(demand.left_color, pair.left, "left", meshes.left.mesh, frame.left_rect,
                       frame.left_color)) {
    return *e;
  }
  if (auto e = colored(demand.right_color, pair.right, "right", meshes.right_unshifted,
                       frame.right_rect, frame.right_color)) {
    return *e;
  }
  return frame;
}

}  // namespace fpga_stereo
