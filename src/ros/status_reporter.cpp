#include "ros/status_reporter.hpp"

#include <fmt/format.h>

#include <utility>

namespace fpga_stereo {
namespace {

const ros::WallDuration kRepeatLog(60.0);  // a lasting trouble is logged again after this time

}  // namespace

StatusReporter::StatusReporter(ros::NodeHandle& nh, ros::NodeHandle& private_nh,
                               const std::string& node_name, Health& health,
                               const StatusSource& sources)
    : health_(health),
      sources_(sources),
      status_(private_nh.advertise<StereoStatus>("status", 1, true)),
      updater_(nh, private_nh, node_name) {
  updater_.setHardwareID("none");
  updater_.add(sources.product(), this, &StatusReporter::diagnose);
  if (!sources_.board_report()) return;
  updater_.add("board", [this](diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
    if (const auto board = sources_.board_report()) fill_diagnostics(*board, diagnostics);
  });
}

void StatusReporter::report() {
  publish_status();
  // update() waits in ROS time, which stands still while a bag is paused.
  updater_.force_update();
  log_input_trouble();
  log_source();
}

void StatusReporter::publish_status() {
  StereoStatus status = health_.report(true);
  status.header.stamp = ros::Time::now();
  status.source = name(sources_.active());
  const StateReport state = sources_.state();
  status.state = static_cast<std::uint8_t>(state.state);
  status.state_text = state.text;
  if (const auto board = sources_.board_report()) fill_status(*board, status);
  status_.publish(status);
}

void StatusReporter::log_input_trouble() {
  const auto trouble =
      health_.has_subscribers() ? sources_.input_trouble() : std::optional<StateReport>();
  if (!trouble) return logged_troubles_.clear();
  const ros::WallTime now = ros::WallTime::now();
  const auto [logged, is_new] = logged_troubles_.try_emplace(trouble->state, now);
  if (!is_new && now - logged->second <= kRepeatLog) return;
  logged->second = now;
  ROS_WARN_STREAM_NAMED("stereo", "no " << sources_.product() << ": " << trouble->text);
}

void StatusReporter::log_missing_board(const BoardReport& board, bool was_connected) const {
  const bool is_refused = board.device.state == link::LinkState::kRefused;
  const std::string text =
      fmt::format("{}, so {}: {}",
                  is_refused      ? "the board is refused"
                  : was_connected ? "the board is lost"
                                  : "there is no board",
                  board.is_required ? "there is no disparity, because backend is board"
                                    : "the software makes the disparity of the image topics",
                  board.device.trouble_text);
  if (is_refused) {
    ROS_ERROR_STREAM_NAMED("stereo", text);
  } else if (was_connected || board.is_expected) {
    ROS_WARN_STREAM_NAMED("stereo", text);
  } else {
    ROS_INFO_STREAM_NAMED("stereo", text);
  }
}

void StatusReporter::log_source() {
  const auto board = sources_.board_report();
  if (!board) return;
  const link::Device::Snapshot& device = board->device;
  const bool is_present = board->ability != link::BoardAbility::kNoBoard;
  // A board that has just been plugged in needs a moment.
  const bool may_come = device.trouble == link::LinkTrouble::kNotOpened ||
                        device.trouble == link::LinkTrouble::kIdentifying;
  if (!is_present && may_come) return;
  const bool has_played = board->ability != link::BoardAbility::kNeedsCalibration;
  if (board->is_recording && !has_played) return;
  const Decision decision{sources_.active(), board->ability,
                          device.state == link::LinkState::kRefused};
  if (logged_decision_ == decision) return;
  const bool was_present =
      logged_decision_ && logged_decision_->ability != link::BoardAbility::kNoBoard;
  logged_decision_ = decision;
  if (!is_present) return log_missing_board(*board, was_present);
  if (board->is_recording && decision.maker == StatusSource::Maker::kBoard) {
    ROS_INFO_STREAM_NAMED("stereo", "the disparity is that of " << device.description);
  } else if (decision.maker == StatusSource::Maker::kSoftware) {
    ROS_INFO_STREAM_NAMED("stereo", "the software makes the disparity: " << board->limitation);
  } else {
    ROS_INFO_STREAM_NAMED("stereo", "the board makes the disparity: " << device.description);
  }
}

void StatusReporter::diagnose(diagnostic_updater::DiagnosticStatusWrapper& diagnostics) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const StateReport state = sources_.state();
  const Severity level = severity(state.state);
  diagnostics.summary(level == Severity::kOk        ? Level::OK
                      : level == Severity::kWarning ? Level::WARN
                                                    : Level::ERROR,
                      state.text);
  const StereoStatus s = health_.report(false);
  diagnostics.add("source", name(sources_.active()));
  diagnostics.add("rate (Hz)", s.rate);
  diagnostics.add("latency (ms)", s.latency_ms);
  diagnostics.add("frames in", s.frames_in);
  diagnostics.add("frames published", s.frames_published);
  for (const DropCauseInfo& cause : kDropCauses) {
    diagnostics.add(std::string("dropped: ") + cause.name, s.*cause.field);
  }
}

}  // namespace fpga_stereo
