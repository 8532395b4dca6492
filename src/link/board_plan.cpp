#include "fpga_stereo/link/board_plan.hpp"

#include <utility>

namespace fpga_stereo::link {
namespace {

constexpr std::size_t kKeptConfigurations = 8;  // no frame in flight is older

constexpr StreamSet kRawStreams{Stream::kRawLeft, Stream::kRawRight};

/// Returns a configuration that every calibration permits: the build's own search range, no
/// rectification.
Result<GatewareConfiguration> raw_configuration(const GatewareBuild& build, cv::Size size) {
  StereoGeometry geometry;
  geometry.image_size = size;
  return make_gateware_configuration(build, parameters_of(build),
                                     identity_rectification(geometry, 0));
}

}  // namespace

void BoardPlan::set_identity(const std::optional<Identity>& identity) {
  identity_ = identity;
  update_configuration();
}

void BoardPlan::set_parameters(const Parameters& parameters, bool is_algorithm_chosen) {
  requested_ = parameters;
  is_algorithm_chosen_ = is_algorithm_chosen;
  update_configuration();
}

void BoardPlan::set_calibration(const StereoCalibration& calibration) {
  calibration_ = calibration;
  update_configuration();
}

Result<bool> BoardPlan::offer_calibration(const StereoCalibration& calibration) {
  if (calibration == calibration_) return false;
  const bool is_calibrated = calibration_.left.K[0] != 0 && calibration_.right.K[0] != 0;
  const auto rectification =
      make_stereo_rectification(calibration.left, calibration.right, parameters_.min_disparity);
  if (is_calibrated && !rectification) return rectification.error();
  set_calibration(calibration);
  return true;
}

void BoardPlan::set_demand(const BoardDemand& demand) {
  demand_ = demand;
  update_streams();
}

bool BoardPlan::is_incomplete(const FrameSet& set) const {
  if (set.dropped.empty()) return false;
  const StreamSet occasional = desired_.raw_interval > 1 ? kRawStreams : StreamSet();
  for (const Stream stream : desired_.streams - occasional) {
    if (set.image(stream).empty()) return true;
  }
  return false;
}

std::shared_ptr<const PlannedConfiguration> BoardPlan::configuration(std::uint64_t tag) const {
  const auto found = configurations_.find(tag);
  return found == configurations_.end() ? nullptr : found->second;
}

void BoardPlan::update_configuration() {
  parameters_ = requested_;
  if (identity_ && !is_algorithm_chosen_) {
    parameters_.stereo_algorithm = parameters_of(identity_->build).stereo_algorithm;
  }
  if (!identity_) {
    ability_ = BoardAbility::kNoBoard;
    limitation_ = "no board is connected";
    return;
  }
  if (options_.host_input && calibration_.left.width == 0) {
    ability_ = BoardAbility::kNeedsCalibration;
    limitation_ = "no pair with a calibration has arrived yet";
    return;
  }
  auto planned = std::make_shared<PlannedConfiguration>();
  planned->parameters = parameters_;
  planned->calibration = calibration_;
  const auto& rectification = rectifications_.get(calibration_, parameters_.min_disparity);
  Result<GatewareConfiguration> made =
      rectification ? make_gateware_configuration(identity_->build, parameters_, **rectification)
                    : Result<GatewareConfiguration>(rectification.error());
  if (const Status streams = check_streams(); made && !streams) made = streams.error();
  if (made) {
    ability_ = BoardAbility::kMakesDisparity;
    limitation_.clear();
    planned->rectification = *rectification;
    planned->image_size = (*rectification)->geometry.image_size;
  } else {
    ability_ = BoardAbility::kSendsRawImages;
    limitation_ = made.error().message;
    const cv::Size calibrated = calibration_.left.image_size();
    planned->image_size = rectification && !calibrated.empty() ? calibrated : options_.image_size;
    made = raw_configuration(identity_->build, planned->image_size);
    if (!options_.host_input && !identity_->streams.contains_all(kRawStreams)) {
      limitation_ +=
          "; the software cannot compute it either, because this gateware does not send "
          "both raw images";
    }
  }
  desired_.configuration.reset();
  if (made) {
    desired_.configuration = std::make_shared<const GatewareConfiguration>(std::move(*made));
  } else {
    ability_ = BoardAbility::kNothing;
    limitation_ = made.error().message;
  }
  ++desired_.tag;
  configurations_[desired_.tag] = std::move(planned);
  while (configurations_.size() > kKeptConfigurations) {
    configurations_.erase(configurations_.begin());
  }
  update_streams();
}

Status BoardPlan::check_streams() const {
  if (!identity_->supports(Stream::kDisparity)) {
    return Error{ErrorKind::kInvalid, "this gateware does not send a disparity"};
  }
  if (options_.host_input && !identity_->supports(Stream::kInput)) {
    return Error{ErrorKind::kInvalid, "this gateware does not take images from the host"};
  }
  return {};
}

StreamSet BoardPlan::streams_of_host_pairs() const {
  if (!makes_disparity() || !demand_.wants_outputs()) return {};
  // The disparity tells that a pair has come back. The host has the raw images already.
  StreamSet streams = Stream::kDisparity;
  if (demand_.rectified_left) streams |= Stream::kRectifiedLeft;
  if (demand_.rectified_right && !is_shifted()) streams |= Stream::kRectifiedRight;
  return streams;
}

Stream BoardPlan::rectified_or_raw(Stream rectified, Stream raw) const {
  return identity_->supports(rectified) ? rectified : raw;
}

StreamSet BoardPlan::streams_of_cameras() const {
  StreamSet streams;
  if (demand_.raw_left) streams |= Stream::kRawLeft;
  if (demand_.raw_right) streams |= Stream::kRawRight;
  if (makes_disparity()) {
    if (demand_.disparity) streams |= Stream::kDisparity;
    if (demand_.rectified_left) {
      streams |= rectified_or_raw(Stream::kRectifiedLeft, Stream::kRawLeft);
    }
    if (demand_.rectified_right) {
      // The board shifts its right image by min_disparity; an unshifted one is made from the raw.
      streams |= is_shifted() ? Stream::kRawRight
                              : rectified_or_raw(Stream::kRectifiedRight, Stream::kRawRight);
    }
  } else if (demand_.wants_outputs()) {
    streams |= kRawStreams;
  }
  if (streams.empty() && demand_.stamps) streams |= Stream::kRawLeft;
  return streams;
}

void BoardPlan::update_streams() {
  if (!identity_) return;
  StreamSet streams = options_.host_input ? streams_of_host_pairs() : streams_of_cameras();
  // Raw images that only verification needs come with some pairs, all others with every pair.
  const bool has_raw = streams.contains_any(kRawStreams);
  const bool verifies = options_.verify_interval > 0 && !options_.host_input && makes_disparity() &&
                        demand_.disparity;
  if (verifies) streams |= kRawStreams;
  desired_.raw_interval = verifies && !has_raw ? options_.verify_interval : 1;
  // The register keeps no bit of a stream that the build does not have.
  desired_.streams = streams & identity_->streams;
  desired_.host_input = options_.host_input;
  desired_.frame_interval = options_.host_input ? 1 : options_.frame_interval;
  desired_.mid_exposure = options_.mid_exposure;
}

}  // namespace fpga_stereo::link
