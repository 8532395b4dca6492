// From the packets of frames to frame sets with configuration tags and host time.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/link/frame_set.hpp"
#include "link/clock.hpp"
#include "link/configuration_tags.hpp"
#include "link/frame_set_builder.hpp"
#include "link/host_clock.hpp"
#include "link/time_sync.hpp"

namespace fpga_stereo::link {

class Receiver {
 public:
  explicit Receiver(bool keep_incomplete) : builder_(FrameAssembler::Options{keep_incomplete}) {}

  /// Adds a leader, rows or a trailer. `expected`: the streams of a complete frame set.
  void add(const Packet& packet, StreamSet expected) { builder_.add(packet, expected, complete_); }
  /// Adds a round trip to the clock.
  void add_round_trip(Time sent, std::uint64_t board_us, Time received);
  /// Remembers a pair that the host sends, to recognise frames that were made from it.
  void add_host_pair(std::uint64_t frame_id, std::uint64_t timestamp);

  struct Context {
    const ConfigurationTags& tags;  // frame sets of other configurations are dropped
    Time now;
    HostClock host;
  };
  /// Moves the frame sets that are complete to received(). Returns true if an image is among them.
  bool deliver(const Context& context);
  /// As deliver(), but ends the frames in flight and moves incomplete frame sets, too. For a link
  /// that was lost, or a board that is identified again.
  bool flush(const Context& context);
  /// Forgets host pairs and the board's clock.
  void forget_board();

  /// Frame sets delivered since they were last taken; the caller takes them out.
  std::vector<ReceivedFrames>& received() { return received_; }
  /// Messages for people; the caller takes them out.
  std::vector<std::string>& notes() { return notes_; }
  const FrameCounters& frame_counters() const { return builder_.counters(); }
  const TimeSync& clock() const { return clock_; }
  std::uint64_t unknown_configurations() const { return unknown_configurations_; }

 private:
  using PairKey = std::pair<std::uint64_t, std::uint64_t>;  // frame_id, timestamp

  /// Sets the stamp, or drops the frames if it is impossible.
  void set_stamp(ReceivedFrames& frames, const Context& context);

  FrameSetBuilder builder_;
  TimeSync clock_;
  std::vector<FrameSet> complete_;
  std::vector<ReceivedFrames> received_;
  std::vector<std::string> notes_;
  std::deque<PairKey> host_pairs_;  // the last ones
  std::uint64_t unknown_configurations_ = 0;
  bool has_noted_missing_clock_ = false;
};

}  // namespace fpga_stereo::link
