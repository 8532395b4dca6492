// What the node did and why there is no disparity: counted in one place, read by ~status and
// diagnostics.
#pragma once

#include <fpga_stereo/StereoStatus.h>
#include <ros/time.h>

#include <array>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/core/result.hpp"

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

/// By DropCause: its words, and its field in the status message.
struct DropCauseInfo {
  const char* words;
  std::uint64_t StereoStatus::*field;
};
constexpr std::array<DropCauseInfo, 9> kDropCauses{{
    {"not synchronised", &StereoStatus::dropped_unsynchronized},
    {"replaced by a newer frame", &StereoStatus::dropped_replaced},
    {"nobody listens any more", &StereoStatus::dropped_unwanted},
    {"stamp", &StereoStatus::dropped_stamp},
    {"encoding", &StereoStatus::dropped_encoding},
    {"image size", &StereoStatus::dropped_image_size},
    {"uncalibrated", &StereoStatus::dropped_uncalibrated},
    {"calibration", &StereoStatus::dropped_calibration},
    {"link to the board", &StereoStatus::dropped_link},
}};

/// The cause that an error of core stands for.
DropCause cause_of(ErrorKind kind);

/// Thread-safe counters. Times are ROS times, so that replayed bags read right.
class Health {
 public:
  void received();
  void dropped(DropCause cause, std::uint64_t frames = 1);
  /// Dropped with an explanation that holds until a frame is published.
  void refused(DropCause cause, const std::string& why);
  void published(const StageTimes& stages, double publish_ms, double latency_ms);
  /// From a board's last byte to all outputs published.
  void link_latency(double ms);
  void listening(bool anyone);

  /// All but header, source and state; rate and means start anew where `restart` is set.
  StereoStatus report(bool restart);
  std::uint64_t published_count() const;
  /// Why the last frame was refused; empty where none was since the last published one.
  std::string refusal() const;
  bool anyone_listens() const;

 private:
  mutable std::mutex mutex_;
  std::uint64_t in_ = 0, published_ = 0;
  std::array<std::uint64_t, kDropCauses.size()> dropped_{};
  std::string refusal_;
  bool listening_ = false;

  // Since the last restart.
  ros::WallTime since_ = ros::WallTime::now();
  std::uint64_t frames_ = 0;
  StageTimes stage_ms_{};
  double publish_ms_ = 0, latency_ms_ = 0;
  std::vector<double> link_latency_ms_;
};

}  // namespace fpga_stereo
