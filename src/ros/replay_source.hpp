// Frames of a recorded board. The recording is played once, from the moment of the first demand.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "core/thread_safety.hpp"
#include "fpga_stereo/link/board_plan.hpp"
#include "fpga_stereo/link/recording_player.hpp"
#include "ros/board_frames.hpp"
#include "ros/board_input.hpp"
#include "ros/board_settings.hpp"
#include "ros/camera_topics.hpp"
#include "ros/health.hpp"
#include "ros/replay_clock.hpp"
#include "ros/rewind_detector.hpp"
#include "ros/stamp_gate.hpp"
#include "ros/verifier.hpp"

namespace fpga_stereo {

/// Publishes what the board computed only if the recording contains the board's configuration, and
/// the calibration files and min_disparity give exactly its meshes: then parameters and geometry of
/// the frames are known. Otherwise the software computes from the recorded raw images, if there are
/// any.
class ReplaySource : public BoardInput {
 public:
  /// `cameras`, `health` and `gate` must outlive the source.
  ReplaySource(const BoardSettings& settings, CameraTopics& cameras, Health& health,
               StampGate& gate, Callbacks callbacks);
  ~ReplaySource() override;
  ReplaySource(const ReplaySource&) = delete;
  ReplaySource& operator=(const ReplaySource&) = delete;

  bool is_present() const override FPGA_STEREO_EXCLUDES(mutex_);
  bool makes_disparity() const override FPGA_STEREO_EXCLUDES(mutex_);
  bool send(const SourcePair&) override { return false; }
  Parameters parameters() const override FPGA_STEREO_EXCLUDES(mutex_);
  void set_demand(const Demand& demand) override FPGA_STEREO_EXCLUDES(mutex_);
  void set_settings(const Settings& settings) override FPGA_STEREO_EXCLUDES(mutex_);
  void refresh() override {}
  Status reset() override;
  std::optional<StateReport> trouble() const override FPGA_STEREO_EXCLUDES(mutex_);
  BoardReport report() const override FPGA_STEREO_EXCLUDES(mutex_);

 private:
  using Planned = link::PlannedConfiguration;
  using Recorded = std::shared_ptr<const link::RecordedConfiguration>;

  // Called from the thread that plays.
  void play() FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns false if the source is being destroyed.
  bool wait_for_demand() FPGA_STEREO_EXCLUDES(mutex_);
  bool is_stopping() const FPGA_STEREO_EXCLUDES(mutex_);
  void take(const link::RecordingPlayer::Frames& frames) FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns what made the frames, or why that is not known.
  Result<std::shared_ptr<const Planned>> plan(const Recorded& recorded, int min_disparity) const;
  /// Notes what the recording provides; logs a change.
  void note_ability(link::BoardAbility ability, const std::string& limitation)
      FPGA_STEREO_EXCLUDES(mutex_);
  void note_progress() FPGA_STEREO_EXCLUDES(mutex_);
  void note_end(const Error& why) FPGA_STEREO_EXCLUDES(mutex_);

  const BoardSettings settings_;
  CameraTopics& cameras_;
  Health& health_;
  StampGate& gate_;
  const Callbacks callbacks_;
  Verifier verifier_;

  // Used by the thread that plays.
  std::unique_ptr<link::RecordingPlayer> player_;
  ReplayClock clock_;
  RewindDetector rewinds_;
  // What planned_ was made from.
  bool has_planned_ = false;
  Recorded recorded_;
  StereoCalibration calibration_;
  int min_disparity_ = 0;
  Result<std::shared_ptr<const Planned>> planned_ = Error{};

  mutable Mutex mutex_;
  ConditionVariable changed_;
  bool is_stopping_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  bool is_wanted_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  bool has_ended_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  Settings node_settings_ FPGA_STEREO_GUARDED_BY(mutex_);
  Demand demand_ FPGA_STEREO_GUARDED_BY(mutex_);
  BoardReport report_ FPGA_STEREO_GUARDED_BY(mutex_);

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace fpga_stereo
