// The state of the node, as ~status.state and diagnostics report it.
#pragma once

#include <fpga_stereo/StereoStatus.h>

#include <cstdint>
#include <string>

namespace fpga_stereo {

/// Why there is a disparity or none. StereoStatus.msg explains each value.
enum class NodeState : std::uint8_t {
  kIdle = StereoStatus::IDLE,
  kStreaming = StereoStatus::STREAMING,
  kWaitingForImages = StereoStatus::WAITING_FOR_IMAGES,
  kWaitingForCameraInfo = StereoStatus::WAITING_FOR_CAMERA_INFO,
  kUnsynchronised = StereoStatus::UNSYNCHRONISED,
  kBadStamp = StereoStatus::BAD_STAMP,
  kBadImage = StereoStatus::BAD_IMAGE,
  kUncalibrated = StereoStatus::UNCALIBRATED,
  kBadCalibration = StereoStatus::BAD_CALIBRATION,
  kNoBoard = StereoStatus::NO_BOARD,
  kBoardStarting = StereoStatus::BOARD_STARTING,
  kBoardRefused = StereoStatus::BOARD_REFUSED,
  kBoardUnsuitable = StereoStatus::BOARD_UNSUITABLE,
  kBoardTrouble = StereoStatus::BOARD_TROUBLE,
  kStarting = StereoStatus::STARTING,
  kRecordingEnded = StereoStatus::RECORDING_ENDED,
};

/// A state with its explanation for people; the text decides nothing.
struct StateReport {
  NodeState state = NodeState::kIdle;
  std::string text;
};

enum class Severity {
  kOk,
  kWarning,  // degraded; it may pass by itself
  kError,    // the user has to act
};

constexpr Severity severity(NodeState state) {
  switch (state) {
    case NodeState::kIdle:
    case NodeState::kStreaming:
    case NodeState::kStarting:
      return Severity::kOk;
    case NodeState::kBadStamp:
    case NodeState::kBadImage:
    case NodeState::kUncalibrated:
    case NodeState::kBadCalibration:
    case NodeState::kBoardRefused:
    case NodeState::kBoardUnsuitable:
      return Severity::kError;
    default:
      return Severity::kWarning;
  }
}

}  // namespace fpga_stereo
