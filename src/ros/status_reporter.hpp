// Reports the state of the node: ~status, diagnostics and the log.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/ros.h>

#include <map>
#include <optional>
#include <string>

#include "ros/health.hpp"
#include "ros/status_source.hpp"

namespace fpga_stereo {

/// For one thread at a time.
class StatusReporter {
 public:
  /// `health` and `sources` must outlive the reporter. `node_name` names the diagnostics.
  StatusReporter(ros::NodeHandle& nh, ros::NodeHandle& private_nh, const std::string& node_name,
                 Health& health, const StatusSource& sources);

  /// Publishes status and diagnostics, and logs changes. Call about once a second.
  void report();

 private:
  void publish_status();
  void log_input_trouble();
  void log_source();
  /// Logs that no board is connected; `was_connected`: it has just gone.
  void log_missing_board(const BoardReport& board, bool was_connected) const;
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& diagnostics);

  Health& health_;
  const StatusSource& sources_;
  ros::Publisher status_;
  diagnostic_updater::Updater updater_;

  /// When each trouble of the input was last logged; empty while there is none.
  std::map<NodeState, ros::WallTime> logged_troubles_;
  /// What decides who makes the disparity, as logged last.
  struct Decision {
    StatusSource::Maker maker;
    link::BoardAbility ability;
    bool is_board_refused;

    bool operator==(const Decision& other) const {
      return maker == other.maker && ability == other.ability &&
             is_board_refused == other.is_board_refused;
    }
  };
  std::optional<Decision> logged_decision_;
};

}  // namespace fpga_stereo
