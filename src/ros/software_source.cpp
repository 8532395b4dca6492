#include "fpga_stereo/ros/software_source.hpp"

#include <ros/console.h>

#include <utility>

#include "fpga_stereo/ros/conversions.hpp"

namespace fpga_stereo {
namespace {

/// Adds to `images` what is asked for and not there yet. `image` has been read as grey before.
Status add_pictures(const sensor_msgs::ImageConstPtr& image, const std::string& camera,
                    const Mesh& mesh, const CameraDemand& demand, int num_threads,
                    CameraImages& images) {
  if (demand.rect && images.rect.empty()) {
    rectify_in_bands(images.mono, mesh, num_threads, images.rect);
  }
  if (!demand.color && !demand.rect_color) return {};
  const auto color = to_bgr(image, camera);
  if (!color) return color.error();
  images.color = *color;
  if (demand.rect_color && color->channels() == 1 && !images.rect.empty()) {
    images.rect_color = images.rect;
  } else if (demand.rect_color) {
    rectify_in_bands(*color, mesh, num_threads, images.rect_color);
  }
  return {};
}

}  // namespace

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
  const auto& made = rectification(pair, settings.pipeline.min_disparity);
  if (!made) return made.error();
  const StereoRectification& meshes = *made;
  const auto left = to_grey(pair.left, "left");
  if (!left) return left.error();
  const auto right = to_grey(pair.right, "right");
  if (!right) return right.error();
  if (Status s = validate_image(*left, meshes, "left"); !s) return s.error();
  if (Status s = validate_image(*right, meshes, "right"); !s) return s.error();

  StereoFrame frame;
  frame.left.header = pair.left->header;
  frame.right.header = pair.right->header;
  frame.right.header.stamp = frame.left.header.stamp;
  frame.left.mono = *left;
  frame.right.mono = *right;
  frame.left_info = *pair.left_info;
  frame.geometry = meshes.geometry;
  frame.settings = settings;
  const int threads = settings.num_threads;
  if (demand.disparity) {
    const Taps& taps = pipeline_.process(*left, *right, meshes, settings.pipeline, threads);
    frame.disparity = taps.disparity;
    frame.left.rect = taps.left;
    if (settings.pipeline.min_disparity == 0) frame.right.rect = taps.right;
    frame.ms = taps.ms;
  }
  Status added =
      add_pictures(pair.left, "left", meshes.left.mesh, demand.left, threads, frame.left);
  if (added) {
    added = add_pictures(pair.right, "right", meshes.right_unshifted, demand.right, threads,
                         frame.right);
  }
  if (!added) return added.error();
  return frame;
}

}  // namespace fpga_stereo
