// Frames made by a board, from its own cameras or from pairs that the host sends it. What the board
// cannot make goes to the software as raw pairs.
#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "core/thread_safety.hpp"
#include "fpga_stereo/link/board_plan.hpp"
#include "fpga_stereo/link/device.hpp"
#include "ros/board_frames.hpp"
#include "ros/board_input.hpp"
#include "ros/board_log.hpp"
#include "ros/board_settings.hpp"
#include "ros/camera_topics.hpp"
#include "ros/health.hpp"
#include "ros/pairs_in_flight.hpp"
#include "ros/stamp_gate.hpp"
#include "ros/verifier.hpp"

namespace fpga_stereo {

/// Locks, in this order: presence_mutex_, mutex_, then those of the device.
class BoardSource : public BoardInput {
 public:
  /// `cameras`, `health` and `gate` must outlive the source.
  BoardSource(const BoardSettings& settings, CameraTopics& cameras, Health& health, StampGate& gate,
              Callbacks callbacks);

  bool is_present() const override FPGA_STEREO_EXCLUDES(mutex_);
  bool makes_disparity() const override FPGA_STEREO_EXCLUDES(mutex_);
  bool send(const SourcePair& pair) override FPGA_STEREO_EXCLUDES(mutex_);
  Parameters parameters() const override FPGA_STEREO_EXCLUDES(mutex_);
  void set_demand(const Demand& demand) override FPGA_STEREO_EXCLUDES(mutex_);
  void set_settings(const Settings& settings) override FPGA_STEREO_EXCLUDES(mutex_);
  void refresh() override FPGA_STEREO_EXCLUDES(presence_mutex_, mutex_);
  Status reset() override;
  std::optional<StateReport> trouble() const override FPGA_STEREO_EXCLUDES(mutex_);
  BoardReport report() const override FPGA_STEREO_EXCLUDES(mutex_);

 private:
  using Clock = std::chrono::steady_clock;
  using Planned = link::PlannedConfiguration;
  using Received = link::ReceivedFrames;

  link::Device::Options device_options();
  link::Device::Callbacks device_callbacks();

  // Presence: board_source.cpp.
  void on_identified(const link::Identity& identity) FPGA_STEREO_EXCLUDES(presence_mutex_, mutex_);
  void on_closed() FPGA_STEREO_EXCLUDES(presence_mutex_, mutex_);
  /// Ends the presence of the board. Returns the pairs that it will not answer, or nullopt if no
  /// board was present.
  std::optional<std::vector<SourcePair>> leave() FPGA_STEREO_REQUIRES(presence_mutex_)
      FPGA_STEREO_EXCLUDES(mutex_);
  /// Gives pairs in flight to the software, or drops them if only the board may compute.
  void hand_over(const std::vector<SourcePair>& pairs);
  bool is_asked_for() const;
  /// Logs once per board that its build decides about stereo_algorithm.
  void announce_algorithm(const link::Identity& identity) FPGA_STEREO_REQUIRES(mutex_);
  /// Passes the plan to the device; logs a change of what the board can do.
  void apply_plan() FPGA_STEREO_REQUIRES(mutex_);

  // What arrives: board_source_receive.cpp.
  /// What belongs to a received frame set.
  struct Context {
    std::shared_ptr<const Planned> planned;
    Settings settings;
    Demand demand;
    bool is_unwanted = false;    // sent before the last subscriber left
    bool is_incomplete = false;  // an image in demand was dropped
  };
  void on_received(const Received& received) FPGA_STEREO_EXCLUDES(mutex_);
  Context context_of(const Received& received) const FPGA_STEREO_REQUIRES(mutex_);
  void receive_host_pair(const Received& received) FPGA_STEREO_EXCLUDES(mutex_);
  void receive_camera_pair(const Received& received) FPGA_STEREO_EXCLUDES(mutex_);
  /// Refuses sets that cannot be used with this context.
  Status check(const Received& received, const Context& context) const;
  /// Counts the frames that are missing before this one as lost.
  void count_lost(const link::FrameSet& set) FPGA_STEREO_REQUIRES(mutex_);
  void verify(const link::FrameSet& set, const Planned& planned, const SourcePair& pair);

  const BoardSettings settings_;
  CameraTopics& cameras_;
  Health& health_;
  StampGate& gate_;
  const Callbacks callbacks_;
  BoardLog log_;
  Verifier verifier_;
  std::atomic<bool> none_found_{false};  // the last attempt to open found no device

  /// Held while a board comes or goes, so that both cannot interleave.
  Mutex presence_mutex_ FPGA_STEREO_ACQUIRED_BEFORE(mutex_);

  mutable Mutex mutex_;
  link::BoardPlan plan_ FPGA_STEREO_GUARDED_BY(mutex_);
  link::BoardAbility logged_ability_ FPGA_STEREO_GUARDED_BY(mutex_) =
      link::BoardAbility::kMakesDisparity;
  std::string logged_limitation_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::string announced_board_ FPGA_STEREO_GUARDED_BY(mutex_);
  Settings node_settings_ FPGA_STEREO_GUARDED_BY(mutex_);
  Demand demand_ FPGA_STEREO_GUARDED_BY(mutex_);
  PairsInFlight in_flight_ FPGA_STEREO_GUARDED_BY(mutex_);
  /// frame_id of the last set from the cameras; nullopt: none since streams were last switched on.
  std::optional<std::uint64_t> last_frame_ FPGA_STEREO_GUARDED_BY(mutex_);

  std::uint64_t clock_steps_ = 0;  // of the last set; used by on_received() only

  link::Device device_;  // last: its threads use all of the above
};

}  // namespace fpga_stereo
