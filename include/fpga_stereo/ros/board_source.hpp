// Frames made by a board: of its own cameras' images, or of pairs that it is sent. What the board
// cannot do is left to the software pipeline, and the reason is told.
#pragma once

#include <ros/time.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "fpga_stereo/link/device.hpp"
#include "fpga_stereo/ros/board_plan.hpp"
#include "fpga_stereo/ros/board_settings.hpp"
#include "fpga_stereo/ros/camera_topics.hpp"
#include "fpga_stereo/ros/frame.hpp"
#include "fpga_stereo/ros/health.hpp"
#include "fpga_stereo/ros/stamp_gate.hpp"
#include "fpga_stereo/ros/topic_input.hpp"
#include "fpga_stereo/ros/verifier.hpp"

namespace fpga_stereo {

class BoardSource {
 public:
  static constexpr const char* kName = "board";

  /// Called from the device's thread.
  struct Callbacks {
    std::function<void(const StereoFrame&)> frame;
    /// A raw pair whose disparity the board cannot make, or will not any more.
    std::function<void(const InputPair&)> pair;
    /// How far the board can be used has changed.
    std::function<void()> changed;
  };

  BoardSource(const BoardSettings& settings, CameraTopics& cameras, Health& health,
              Callbacks callbacks);

  /// A board answers, and it is one that this software works with.
  bool present() const;
  /// Why the board does not make the disparity, though it is present; empty where it does.
  std::string unable() const;
  /// The board takes pairs from topics, now.
  bool takes_pairs() const;
  /// Sends a pair; false: it cannot be sent now.
  bool send(const InputPair& pair);

  void set_demand(const Demand& demand);
  void set_settings(const Settings& settings);
  /// To be called now and then: sees a new calibration, and a board that has gone.
  void refresh();
  void reset() { device_.reset(); }

  /// Why there are no frames of the board; empty where there are.
  std::string complaint() const;
  link::Device::Snapshot snapshot() const { return device_.snapshot(); }
  Verifier::Counters verified() const { return verifier_.counters(); }

 private:
  link::Device::Callbacks device_callbacks();
  void identified(const link::Identity& identity);
  void closed();
  void received(const std::vector<link::Session::Received>& sets);
  void take(const link::Session::Received& received);
  void take_pair(const link::Session::Received& received, const BoardPlan::Made& made);
  void take_camera_frame(const link::Session::Received& received, const BoardPlan::Made& made);
  void count_lost(const link::FrameSet& set);
  void refuse(const std::string& why);
  /// Tells the device what is wanted. With mutex_.
  void tell();

  const BoardSettings settings_;
  CameraTopics& cameras_;
  Health& health_;
  Callbacks callbacks_;
  Verifier verifier_;

  mutable std::mutex mutex_;
  BoardPlan plan_;
  std::map<std::uint64_t, InputPair> sent_;  // by frame_id, not come back yet
  std::uint64_t next_pair_ = 1;
  StampGate gate_;
  std::optional<std::uint64_t> last_frame_;  // frame_id

  link::Device device_;  // last: its thread uses all of the above
};

}  // namespace fpga_stereo
