#include "ros/board_source.hpp"

#include <chrono>
#include <cmath>
#include <tuple>
#include <utility>

#include "fpga_stereo/link/transport.hpp"
#include "ros/make_frame.hpp"

namespace fpga_stereo {
namespace {

using link::BoardAbility;
using link::LinkState;

link::BoardPlan::Options plan_options(const BoardSettings& settings) {
  link::BoardPlan::Options options;
  options.host_input = settings.topic_input;
  options.image_size = settings.image_size;
  options.frame_interval = settings.frame_interval;
  options.verify_interval = settings.verify;
  options.mid_exposure = std::chrono::microseconds(std::lround(settings.mid_exposure_ms * 1000));
  return options;
}

/// Cameras: frame_ids rise by frame_interval from one sent frame to the next.
std::uint64_t verify_interval(const BoardSettings& settings) {
  const int step = settings.topic_input ? 1 : settings.frame_interval;
  return static_cast<std::uint64_t>(settings.verify) * static_cast<std::uint64_t>(step);
}

link::BoardDemand board_demand(const Demand& outputs, const CameraTopics::Demand& cameras) {
  link::BoardDemand demand;
  demand.disparity = outputs.disparity;
  demand.rectified_left = outputs.left.any_rectified();
  demand.rectified_right = outputs.right.any_rectified();
  demand.raw_left = outputs.left.any_raw() || cameras.left;
  demand.raw_right = outputs.right.any_raw() || cameras.right;
  demand.stamps = cameras.info;
  return demand;
}

}  // namespace

BoardSource::BoardSource(const BoardSettings& settings, CameraTopics& cameras, Health& health,
                         StampGate& gate, Callbacks callbacks)
    : settings_(settings),
      cameras_(cameras),
      health_(health),
      gate_(gate),
      callbacks_(std::move(callbacks)),
      verifier_(verify_interval(settings)),
      plan_(plan_options(settings)),
      device_(device_options(), device_callbacks()) {}

link::Device::Options BoardSource::device_options() {
  link::Device::Options options;
  options.open = [this] {
    auto opened = link::open_transport(settings_.device);
    none_found_ = !opened && opened.error().kind == ErrorKind::kNotFound;
    return opened;
  };
  options.hotplug = link::watch_for(settings_.device);
  options.session.keep_incomplete = settings_.keep_incomplete;
  return options;
}

link::Device::Callbacks BoardSource::device_callbacks() {
  link::Device::Callbacks callbacks;
  callbacks.received = [this](const Received& received) { on_received(received); };
  callbacks.identified = [this](const link::Identity& identity) { on_identified(identity); };
  callbacks.closed = [this] { on_closed(); };
  callbacks.note = [this](const std::string& note) { log_.info("board: " + note); };
  return callbacks;
}

void BoardSource::announce_algorithm(const link::Identity& identity) {
  const bool is_default = plan_.parameters().stereo_algorithm == StereoAlgorithm::kSgm;
  if (node_settings_.is_algorithm_chosen || is_default) return;
  if (std::exchange(announced_board_, identity.text()) == identity.text()) return;
  std::string text = "the board is built for window matching, so the node uses that";
  if (settings_.backend == Backend::kAuto) {
    text += "; set stereo_algorithm to sgm to have the software do semi-global matching instead";
  }
  log_.info(text);
}

void BoardSource::apply_plan() {
  if (!plan_.has_board()) return;
  const auto told = std::tie(logged_ability_, logged_limitation_);
  if (told != std::make_tuple(plan_.ability(), plan_.limitation())) {
    const bool is_limited =
        !plan_.makes_disparity() && plan_.ability() != BoardAbility::kNeedsCalibration;
    if (is_limited) {
      log_.warn("the board cannot make this disparity: " + plan_.limitation());
    }
    logged_ability_ = plan_.ability();
    logged_limitation_ = plan_.limitation();
  }
  // The board numbers its frames on while it sends none.
  if (plan_.desired_state().streams.empty()) last_frame_.reset();
  device_.set_desired_state(plan_.desired_state());
}

void BoardSource::on_identified(const link::Identity& identity) {
  log_.info("board identified: " + identity.text());
  std::vector<SourcePair> unanswered;
  {
    const MutexLock presence(presence_mutex_);
    if (!settings_.topic_input) cameras_.set_advertised(true);
    const StereoCalibration calibration = cameras_.calibration();
    const MutexLock lock(mutex_);
    last_frame_.reset();
    unanswered = in_flight_.take_all();
    if (!settings_.topic_input) plan_.set_calibration(calibration);
    plan_.set_identity(identity);
    announce_algorithm(identity);
    apply_plan();
  }
  hand_over(unanswered);
  callbacks_.changed();
}

void BoardSource::on_closed() {
  std::optional<std::vector<SourcePair>> unanswered;
  {
    const MutexLock presence(presence_mutex_);
    unanswered = leave();
  }
  if (!unanswered) return;
  hand_over(*unanswered);
  callbacks_.changed();
}

std::optional<std::vector<SourcePair>> BoardSource::leave() {
  std::vector<SourcePair> unanswered;
  {
    const MutexLock lock(mutex_);
    if (!plan_.has_board()) return std::nullopt;
    plan_.set_identity(std::nullopt);
    unanswered = in_flight_.take_all();
  }
  cameras_.set_advertised(false);
  return unanswered;
}

void BoardSource::hand_over(const std::vector<SourcePair>& pairs) {
  if (settings_.backend == Backend::kBoard) {
    return health_.dropped(DropCause::kLink, pairs.size());
  }
  for (const SourcePair& pair : pairs) callbacks_.pair(pair);
}

void BoardSource::refresh() {
  std::optional<std::vector<SourcePair>> unanswered;
  {
    // The state is read with the lock: on_identified() cannot run in between.
    const MutexLock presence(presence_mutex_);
    if (device_.snapshot().state == LinkState::kRefused) unanswered = leave();
  }
  if (unanswered) {
    hand_over(*unanswered);
    callbacks_.changed();
  }
  if (settings_.topic_input) return;
  const StereoCalibration calibration = cameras_.calibration();
  const MutexLock lock(mutex_);
  if (!plan_.has_board()) return;
  const Result<bool> is_new = plan_.offer_calibration(calibration);
  if (!is_new) {
    log_.info("the new calibration is not used until both cameras agree: " +
              is_new.error().message);
  } else if (*is_new) {
    apply_plan();
  }
}

void BoardSource::set_settings(const Settings& settings) {
  const MutexLock lock(mutex_);
  node_settings_ = settings;
  plan_.set_parameters(settings.pipeline, settings.is_algorithm_chosen);
  apply_plan();
}

void BoardSource::set_demand(const Demand& demand) {
  const CameraTopics::Demand cameras = cameras_.demand();
  const MutexLock lock(mutex_);
  demand_ = demand;
  plan_.set_demand(board_demand(demand, cameras));
  apply_plan();
}

bool BoardSource::send(const SourcePair& pair) {
  const MutexLock lock(mutex_);
  if (!settings_.topic_input || !plan_.has_board()) return false;
  const RawPair& raw = pair.raw;
  health_.dropped(DropCause::kLink, in_flight_.give_up_late(Clock::now()));
  if (raw.calibration != plan_.calibration()) {
    plan_.set_calibration(raw.calibration);
    apply_plan();
  }
  const std::uint64_t tag = plan_.desired_state().tag;
  const auto planned = plan_.configuration(tag);
  const link::Device::Snapshot device = device_.snapshot();
  const bool is_ready = plan_.makes_disparity() && planned && planned->rectification &&
                        device.state == LinkState::kStreaming && device.active_tag == tag;
  if (is_ready) {
    // The software refuses a pair of a wrong size by name.
    if (!check_pair_size(raw, *planned->rectification)) return false;
    const auto stamp_us = static_cast<std::uint64_t>(raw.stamp_ns / 1000);
    if (!in_flight_.is_full() &&
        device_.send_pair(raw.left, raw.right, in_flight_.next_id(), stamp_us)) {
      in_flight_.add(pair, Clock::now());
      return true;
    }
  } else if (in_flight_.is_empty()) {
    return false;
  }
  // Dropped, because the software would overtake the pairs in flight.
  health_.dropped(DropCause::kReplaced);
  return true;
}

bool BoardSource::is_present() const {
  const MutexLock lock(mutex_);
  return plan_.has_board();
}

Parameters BoardSource::parameters() const {
  const MutexLock lock(mutex_);
  return plan_.parameters();
}

bool BoardSource::makes_disparity() const {
  const MutexLock lock(mutex_);
  return plan_.makes_disparity();
}

bool BoardSource::is_asked_for() const {
  return settings_.backend == Backend::kBoard || settings_.device != BoardSettings().device;
}

Status BoardSource::reset() {
  const link::Device::Snapshot device = device_.snapshot();
  if (device.state == LinkState::kClosed) {
    return Error{ErrorKind::kNotFound, "no board is connected: " + device.trouble_text};
  }
  device_.reset();
  return {};
}

std::optional<StateReport> BoardSource::trouble() const { return link_trouble(device_.snapshot()); }

BoardReport BoardSource::report() const {
  BoardReport report;
  report.device = device_.snapshot();
  report.is_expected = is_asked_for() || !none_found_ || report.device.times_opened > 0;
  report.is_required = settings_.backend == Backend::kBoard;
  report.verified = verifier_.counters();
  const MutexLock lock(mutex_);
  report.ability = plan_.ability();
  report.limitation = plan_.limitation();
  return report;
}

}  // namespace fpga_stereo
