// The inputs and sources of the node, and the decisions between them: which source gets a pair,
// when the topics are subscribed, and what state the node is in.
#pragma once

#include <ros/ros.h>

#include <functional>
#include <memory>
#include <optional>

#include "ros/board_input.hpp"
#include "ros/board_report.hpp"
#include "ros/board_settings.hpp"
#include "ros/camera_topics.hpp"
#include "ros/demand.hpp"
#include "ros/frame_publisher.hpp"
#include "ros/health.hpp"
#include "ros/outputs.hpp"
#include "ros/settings.hpp"
#include "ros/software_source.hpp"
#include "ros/stamp_gate.hpp"
#include "ros/status_source.hpp"
#include "ros/topic_input.hpp"

namespace fpga_stereo {

/// Owns software, board and topics. With backend `auto` the board makes the disparity if it can,
/// and the software otherwise.
///
/// set_settings() and set_demand() are for one thread at a time, the rest is thread-safe.
class Sources : public StatusSource {
 public:
  struct Options {
    PairKind topics = PairKind::kRaw;
    SyncSettings sync;
    BoardSettings board;
  };

  /// Hands frames to `publisher`, and images that need no partner to `outputs`. Calls `changed`,
  /// from threads of its own and without a lock, when the demand has to be set again. `health`,
  /// `outputs` and `publisher` must outlive the sources.
  Sources(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh, const Options& options,
          Health& health, Outputs& outputs, FramePublisher& publisher,
          const std::function<void()>& changed);
  /// Stops the topics first, then the board, then the software. Blocks until their threads end.
  ~Sources();
  Sources(const Sources&) = delete;
  Sources& operator=(const Sources&) = delete;

  void set_settings(const Settings& settings);
  /// Makes the sources compute what is in demand, and subscribes to the topics if they are needed.
  void set_demand(const Demand& demand);
  /// Call about once a second.
  void refresh();
  /// Resets the link to the board. Fails if no board is connected; the message says why.
  Status reset_board();

  const char* product() const override { return "disparity"; }
  const Health& health() const override { return health_; }
  Maker active() const override;
  std::optional<StateReport> input_trouble() const override;
  std::string origin() const override;
  std::optional<BoardReport> board_report() const override;
  bool has_board() const { return board_ != nullptr && board_->is_present(); }

 private:
  /// The software computes a board's pairs with the board's stereo_algorithm.
  void update_software();
  void make_board(const ros::NodeHandle& nh, Outputs& outputs,
                  const std::function<void()>& changed);
  /// True if the pairs come from topics, not from the cameras of a board.
  bool needs_topics() const;
  /// Notes where the pairs come from: after a change, the first frame is still expected.
  void note_input(bool needs_topics);
  void on_pair(const SourcePair& pair);
  /// Says why the board did not take a pair.
  StateReport refusal_of_board() const;

  const BoardSettings board_settings_;
  Health& health_;
  FramePublisher& publisher_;
  StampGate gate_;
  Settings settings_;                               // of set_settings()
  bool needed_topics_ = false, had_board_ = false;  // at the last set_demand()
  // All are set by the constructor and never change; no board if the backend is the software.
  std::unique_ptr<SoftwareSource> software_;
  std::unique_ptr<CameraTopics> cameras_;
  std::unique_ptr<BoardInput> board_;
  std::unique_ptr<TopicInput> topics_;
};

}  // namespace fpga_stereo
