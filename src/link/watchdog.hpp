// Decides when a link has stopped working, and which step of recovery is next.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "fpga_stereo/link/link_state.hpp"
#include "fpga_stereo/link/session_options.hpp"
#include "link/request_queue.hpp"

namespace fpga_stereo::link {

/// Why the link brings no frames, with a text for people.
struct Trouble {
  LinkTrouble kind = LinkTrouble::kNone;
  std::string text;  // empty for kNone
};

class Watchdog {
 public:
  explicit Watchdog(const SessionOptions& options) : options_(options) {}

  /// The link was opened.
  void start(Time now);
  void on_packet(Time now) { last_packet_ = now; }
  /// A packet of a frame arrived.
  void on_frame_packet(Time now);
  /// Streams were switched on: frames are due from now on, for the pairs after `frames_in`. Frames
  /// of pairs that the host sends are due only after on_pair_sent().
  void on_streams_changed(Time now, std::uint32_t frames_in, bool are_pairs_sent);
  /// The transport has accepted a pair of the host.
  void on_pair_sent(Time now);
  /// Good frames arrived: the link works.
  void on_good_frames(Time now);
  /// The board's counter FRAMES_IN was polled.
  void on_poll(std::uint32_t frames_in, bool is_streaming);
  /// The link works: ends the trouble; the next step will be the mildest.
  void on_success();

  /// Returns the trouble that calls for a step now, if any. `frame_interval`: the board sends every
  /// n-th pair.
  std::optional<Trouble> check(Time now, bool is_streaming, int frame_interval) const;
  /// Returns the step that take() would record next. Read it before resetting the session, because
  /// frames that a reset completes count as success.
  WatchdogStep next_step() const { return next_step_; }
  /// Records a step that begins now; a further one follows after a pause.
  void take(WatchdogStep step, const Trouble& trouble, Time now);

  /// The trouble of the last step, until the link works again.
  const Trouble& trouble() const { return trouble_; }
  /// Steps taken, by WatchdogStep.
  const std::array<std::uint64_t, kNumWatchdogSteps>& steps() const { return steps_; }

 private:
  bool is_stalled(Time now, int frame_interval) const;
  bool is_missing(Time now, int frame_interval) const;

  SessionOptions options_;
  Time last_packet_{}, last_frame_{};
  // Good frames.
  bool are_pairs_sent_ = false;
  std::optional<Time> due_since_;
  Time last_good_{};
  std::array<Clock::duration, 2> intervals_{};  // between the last ones
  int missing_steps_ = 0;                       // taken since the last one
  Time next_check_{};
  bool has_frame_since_poll_ = false;
  std::uint32_t frames_in_ = 0;           // as last polled
  std::uint32_t frames_in_at_frame_ = 0;  // at the first poll after a frame
  WatchdogStep next_step_ = WatchdogStep::kPurge;
  Trouble trouble_;
  std::array<std::uint64_t, kNumWatchdogSteps> steps_{};
};

}  // namespace fpga_stereo::link
