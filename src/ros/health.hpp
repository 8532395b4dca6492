// Counts what happens to frames and remembers why the last one was refused. ~status and
// diagnostics read it.
#pragma once

#include <fpga_stereo/StereoStatus.h>
#include <ros/time.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/log_limiter.hpp"
#include "core/thread_safety.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/core/result.hpp"
#include "ros/node_state.hpp"

namespace fpga_stereo {

enum class DropCause {
  kUnsynchronized,
  kReplaced,
  kUnwanted,
  kStamp,
  kEncoding,
  kImageSize,
  kUncalibrated,
  kCalibration,
  kLink,
};

/// By DropCause: its name for people, its field in the status message, and the state of a node
/// whose frames are refused for it.
struct DropCauseInfo {
  const char* name;
  std::uint64_t StereoStatus::*field;
  NodeState state;
};
constexpr std::array<DropCauseInfo, 9> kDropCauses{{
    {"not synchronised", &StereoStatus::dropped_unsynchronized, NodeState::kUnsynchronised},
    {"replaced by a newer frame", &StereoStatus::dropped_replaced, NodeState::kStreaming},
    {"no subscriber any more", &StereoStatus::dropped_unwanted, NodeState::kIdle},
    {"stamp", &StereoStatus::dropped_stamp, NodeState::kBadStamp},
    {"encoding", &StereoStatus::dropped_encoding, NodeState::kBadImage},
    {"image size", &StereoStatus::dropped_image_size, NodeState::kBadImage},
    {"uncalibrated", &StereoStatus::dropped_uncalibrated, NodeState::kUncalibrated},
    {"calibration", &StereoStatus::dropped_calibration, NodeState::kBadCalibration},
    {"link to the board", &StereoStatus::dropped_link, NodeState::kBoardTrouble},
}};

/// The cause under which a frame is counted that core refused with an error of this kind.
DropCause cause_of(ErrorKind kind);

/// Thread-safe; its lock is a leaf. Rates are per wall time; latencies are differences of ROS
/// times, so that they are right for replayed bags.
class Health {
 public:
  /// Counts a frame that came in.
  void received() FPGA_STEREO_EXCLUDES(mutex_);
  /// Counts frames dropped on purpose, without an explanation.
  void dropped(DropCause cause, std::uint64_t frames = 1) FPGA_STEREO_EXCLUDES(mutex_);
  /// Counts a refused frame. The report holds until a frame is published or nobody subscribes any
  /// more. Logs one line per cause and state every 10 s, as an error if the user has to act.
  void refused(DropCause cause, const std::string& text) FPGA_STEREO_EXCLUDES(mutex_);
  /// The same, with another state than that of the cause.
  void refused(DropCause cause, const StateReport& report) FPGA_STEREO_EXCLUDES(mutex_);
  /// Counts a published frame. Times in ms: of the stages, of publishing, from stamp to published.
  void published(const StageTimes& stages, double publish_ms, double latency_ms)
      FPGA_STEREO_EXCLUDES(mutex_);
  /// Notes the time in ms from a board's last byte to all outputs published.
  void link_latency(double ms) FPGA_STEREO_EXCLUDES(mutex_);
  void set_has_subscribers(bool has_subscribers) FPGA_STEREO_EXCLUDES(mutex_);
  /// Notes that another input begins, whose first frame is still expected.
  void expect_first_frame() FPGA_STEREO_EXCLUDES(mutex_);

  /// Fills all counters, rates and means; `restart` begins a new interval for rates and means.
  StereoStatus report(bool restart) FPGA_STEREO_EXCLUDES(mutex_);
  /// Why the last frame was refused, or nullopt if one was published since.
  std::optional<StateReport> refusal() const FPGA_STEREO_EXCLUDES(mutex_);
  bool has_subscribers() const FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns true if a frame has been published since the first subscriber came and the present
  /// input began.
  bool has_published() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  mutable Mutex mutex_;
  std::uint64_t in_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  std::uint64_t published_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  std::array<std::uint64_t, kDropCauses.size()> dropped_ FPGA_STEREO_GUARDED_BY(mutex_){};
  std::optional<StateReport> refusal_ FPGA_STEREO_GUARDED_BY(mutex_);
  LogLimiter log_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool has_subscribers_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  bool has_published_ FPGA_STEREO_GUARDED_BY(mutex_) = false;

  // Of the present interval.
  ros::WallTime interval_start_ FPGA_STEREO_GUARDED_BY(mutex_) = ros::WallTime::now();
  std::uint64_t frames_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  StageTimes stage_ms_ FPGA_STEREO_GUARDED_BY(mutex_){};
  double publish_ms_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  double latency_ms_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  std::vector<double> link_latency_ms_ FPGA_STEREO_GUARDED_BY(mutex_);
};

}  // namespace fpga_stereo
