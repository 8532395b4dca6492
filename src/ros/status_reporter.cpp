#include "ros/status_reporter.hpp"

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
  const ros::WallTime now = ros::WallTime::now();
  const bool is_new = trouble && !logged_trouble_;
  if (trouble && (is_new || now - last_trouble_log_ > kRepeatLog)) {
    ROS_WARN_STREAM_NAMED("stereo", "no " << sources_.product() << ": " << trouble->text);
    last_trouble_log_ = now;
  }
  logged_trouble_.reset();
  if (trouble) logged_trouble_ = trouble->state;
}

void StatusReporter::log_source() {
  const auto board = sources_.board_report();
  if (!board) return;
  const auto trouble = link_trouble(board->device);
  const Decision decision{sources_.active(), board->ability,
                          board->device.state == link::LinkState::kRefused};
  if (logged_decision_ == decision) return;
  logged_decision_ = decision;
  if (decision.is_board_refused && trouble) {
    ROS_ERROR_STREAM_NAMED("stereo", trouble->text);
  }
  const bool is_present = board->ability != link::BoardAbility::kNoBoard;
  if (decision.maker == StatusSource::Maker::kSoftware) {
    const std::string reason = is_present ? board->limitation
                               : trouble  ? trouble->text
                                          : "no board is connected";
    ROS_INFO_STREAM_NAMED("stereo", "the software makes the disparity: " << reason);
  } else if (is_present) {
    ROS_INFO_STREAM_NAMED("stereo", "the board makes the disparity: " << board->device.description);
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
