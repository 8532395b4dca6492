#include "ros/board_plan.hpp"

#include <ros/console.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "ros/conversions.hpp"

namespace fpga_stereo {
namespace {

using link::Stream;
using link::StreamSet;

constexpr std::size_t kKeptConfigurations = 8;  // frames of older ones are long through

constexpr StreamSet kRawPair{Stream::kRawLeft, Stream::kRawRight};

bool wants_rectified(const CameraDemand& d) { return d.rect || d.rect_color; }
bool wants_raw(const CameraDemand& d) { return d.mono || d.color; }

/// What a board can do whatever the calibration: its own search, images as they are.
Result<GatewareConfiguration> raw_configuration(const GatewareBuild& build, cv::Size size) {
  StereoGeometry geometry;
  geometry.image_size = size;
  return make_gateware_configuration(build, parameters_of(build),
                                     identity_rectification(geometry, 0));
}

}  // namespace

bool same_calibration(const CameraTopics::Infos& a, const CameraTopics::Infos& b) {
  return to_calibration(a.left) == to_calibration(b.left) &&
         to_calibration(a.right) == to_calibration(b.right);
}

void BoardPlan::set_identity(const std::optional<link::Identity>& identity) {
  identity_ = identity;
  configure();
}

void BoardPlan::set_settings(const Settings& settings) {
  node_settings_ = settings;
  configure();
}

void BoardPlan::set_calibration(const CameraTopics::Infos& infos) {
  infos_ = infos;
  configure();
}

Result<bool> BoardPlan::offer_calibration(const CameraTopics::Infos& infos) {
  if (same_calibration(infos, infos_)) return false;
  // The two calls of a calibration come one after the other: until they agree, the old one holds.
  const bool first = infos_.left.K[0] == 0 || infos_.right.K[0] == 0;
  const auto made =
      make_stereo_rectification(to_calibration(infos.left), to_calibration(infos.right),
                                node_settings_.pipeline.min_disparity);
  if (!first && !made) return made.error();
  set_calibration(infos);
  return true;
}

void BoardPlan::set_demand(const Demand& outputs, const CameraTopics::Demand& cameras) {
  demand_ = outputs;
  cameras_ = cameras;
  want();
}

bool BoardPlan::lacks(const link::FrameSet& set) const {
  if (set.dropped.empty()) return false;
  const StreamSet sometimes = wanted_.raw_interval > 1 ? kRawPair : StreamSet();
  for (const Stream stream : wanted_.streams - sometimes) {
    if (set.image(stream).empty()) return true;
  }
  return false;
}

std::shared_ptr<const BoardPlan::Made> BoardPlan::made(std::uint64_t tag) const {
  const auto found = made_.find(tag);
  return found == made_.end() ? nullptr : found->second;
}

void BoardPlan::configure() {
  if (!identity_) return;
  if (settings_.topic_input && infos_.left.width == 0) {
    unable_ = "no calibrated pair has come on its topics yet";
    return;
  }
  auto made = std::make_shared<Made>();
  made->settings = node_settings_;
  made->infos = infos_;
  const std::string before = unable_;
  const auto& rectification =
      rectifier_(infos_.left, infos_.right, node_settings_.pipeline.min_disparity);
  Result<GatewareConfiguration> able =
      rectification
          ? make_gateware_configuration(identity_->build, node_settings_.pipeline, **rectification)
          : Result<GatewareConfiguration>(rectification.error());
  if (const std::string missing = missing_stream(); able && !missing.empty()) {
    able = Error{ErrorKind::kInvalid, missing};
  }
  unable_ = able ? "" : able.error().message;
  if (able) {
    made->rectification = *rectification;
    made->image_size = (*rectification)->geometry.image_size;
  } else {
    const cv::Size calibrated = to_calibration(infos_.left).image_size();
    const bool known = rectification && !calibrated.empty();
    made->image_size = known ? calibrated : settings_.image_size;
    able = raw_configuration(identity_->build, made->image_size);
    if (!settings_.topic_input && !identity_->streams.contains_all(kRawPair)) {
      unable_ += "; and this gateware does not send the raw images that the software needs";
    }
  }
  if (!able) {  // the images are too large for it
    unable_ = able.error().message;
    wanted_.configuration.reset();
  } else {
    wanted_.configuration = std::make_shared<const GatewareConfiguration>(std::move(*able));
  }
  if (unable_ != before && !unable_.empty()) {
    ROS_WARN_STREAM_NAMED("stereo", "the board cannot make this disparity: " << unable_);
  }
  ++wanted_.tag;
  made_[wanted_.tag] = std::move(made);
  while (made_.size() > kKeptConfigurations) made_.erase(made_.begin());
  want();
}

link::StreamSet BoardPlan::streams_of_pairs() const {
  if (!unable_.empty()) return {};
  StreamSet streams;
  if (demand_.any()) streams |= Stream::kDisparity;
  if (wants_rectified(demand_.left)) streams |= Stream::kRectifiedLeft;
  if (wants_rectified(demand_.right) && !shifted()) streams |= Stream::kRectifiedRight;
  return streams;
}

link::Stream BoardPlan::rectified(Stream rectified, Stream raw) const {
  return identity_->supports(rectified) ? rectified : raw;
}

link::StreamSet BoardPlan::streams_of_cameras() const {
  StreamSet streams;
  if (!unable_.empty() && demand_.any()) streams |= kRawPair;
  if (wants_raw(demand_.left) || cameras_.left) streams |= Stream::kRawLeft;
  if (wants_raw(demand_.right) || cameras_.right) streams |= Stream::kRawRight;
  if (unable_.empty()) {
    if (demand_.disparity) streams |= Stream::kDisparity;
    if (wants_rectified(demand_.left)) {
      streams |= rectified(Stream::kRectifiedLeft, Stream::kRawLeft);
    }
    if (wants_rectified(demand_.right)) {
      // The board's right image is shifted by min_disparity: others expect one that is not.
      streams |=
          shifted() ? Stream::kRawRight : rectified(Stream::kRectifiedRight, Stream::kRawRight);
    }
  }
  if (streams.empty() && cameras_.info) streams |= Stream::kRawLeft;
  return streams;
}

std::string BoardPlan::missing_stream() const {
  if (!identity_->supports(Stream::kDisparity)) return "this gateware does not send a disparity";
  if (settings_.topic_input && !identity_->supports(Stream::kInput)) {
    return "this gateware takes no images from the host";
  }
  return "";
}

void BoardPlan::want() {
  if (!identity_) return;
  StreamSet streams = settings_.topic_input ? streams_of_pairs() : streams_of_cameras();
  // Raw images of every frame where somebody wants them, of some for verification alone.
  const bool always = streams.contains_any(kRawPair);
  const bool verifies =
      settings_.verify > 0 && !settings_.topic_input && unable_.empty() && demand_.disparity;
  if (verifies) streams |= kRawPair;
  wanted_.raw_interval = verifies && !always ? settings_.verify : 1;
  // A board does not hold bits of streams that it was built without.
  wanted_.streams = streams & identity_->streams;
  wanted_.host_input = settings_.topic_input;
  // Of the topics' pairs as many are sent as the board takes.
  wanted_.frame_interval = settings_.topic_input ? 1 : settings_.frame_interval;
  wanted_.mid_exposure = std::chrono::microseconds(std::lround(settings_.mid_exposure_ms * 1000));
}

}  // namespace fpga_stereo
