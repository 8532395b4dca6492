// Frames made by a board: of its own cameras' images, or of pairs that it is sent. What the board
// cannot do is left to the software pipeline, and the reason is told.
#pragma once

#include <ros/time.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "fpga_stereo/link/device.hpp"
#include "ros/board_frames.hpp"
#include "ros/board_plan.hpp"
#include "ros/board_settings.hpp"
#include "ros/camera_topics.hpp"
#include "ros/frame.hpp"
#include "ros/health.hpp"
#include "ros/stamp_gate.hpp"
#include "ros/topic_input.hpp"
#include "ros/verifier.hpp"

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
  /// Sends a pair, or drops it where the board is still busy with those before. False: the pair is
  /// the software's.
  bool send(const InputPair& pair);

  void set_demand(const Demand& demand);
  void set_settings(const Settings& settings);
  /// To be called now and then: sees a new calibration, and a board that has gone.
  void refresh();
  void reset() { device_.reset(); }

  /// Why there are no frames of the board; empty where there are.
  std::string complaint() const;
  link::Device::Snapshot snapshot() const { return device_.snapshot(); }
  /// There should be a board: one was asked for, or was there before, or cannot be opened.
  bool expected() const;
  Verifier::Counters verified() const { return verifier_.counters(); }

 private:
  using Clock = std::chrono::steady_clock;
  /// A pair that is under way in the board.
  struct Sent {
    InputPair pair;
    Clock::time_point when;
  };
  using SentPairs = std::map<std::uint64_t, Sent>;  // by frame_id

  link::Device::Options device_options();
  link::Device::Callbacks device_callbacks();
  void identified(const link::Identity& identity);
  void closed();
  /// Pairs that the board will not answer any more.
  void hand_on(const SentPairs& sent);
  void received(const link::ReceivedFrames& received);
  void take_pair(const link::ReceivedFrames& received, const BoardPlan::Made& made,
                 const InputPair& pair, const Demand& demand);
  void take_camera_frame(const link::ReceivedFrames& received, const BoardPlan::Made& made,
                         const Demand& demand);
  /// Where due, has the frame computed in software, too.
  void verify(const link::FrameSet& set, const BoardPlan::Made& made, const cv::Mat& left,
              const cv::Mat& right);
  void refuse(DropCause cause, const std::string& why);

  // With mutex_.
  /// Tells the device what is wanted.
  void tell();
  void count_lost(const link::FrameSet& set);
  /// The pair that a frame was made of; none: it was given up.
  std::optional<InputPair> take_sent(std::uint64_t frame_id);
  /// Pairs of which nothing came for too long are lost.
  void give_up_lost();

  const BoardSettings settings_;
  CameraTopics& cameras_;
  Health& health_;
  Callbacks callbacks_;
  Verifier verifier_;

  mutable std::mutex mutex_;
  BoardPlan plan_;
  SentPairs sent_;
  std::uint64_t next_pair_ = 1;
  Clock::time_point last_back_{};                         // when a pair came back
  Clock::duration turnaround_{std::chrono::seconds(10)};  // of that pair; at first, of a slow line
  std::optional<std::uint64_t> last_frame_;  // frame_id; none: nothing was wanted since

  // Of the device's thread.
  StampGate gate_;                              // of the cameras' frames
  std::optional<std::uint64_t> last_verified_;  // frame_id

  std::atomic<bool> none_found_{false};

  link::Device device_;  // last: its thread uses all of the above
};

}  // namespace fpga_stereo
