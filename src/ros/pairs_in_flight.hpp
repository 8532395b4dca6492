// The host's pairs that a board is working on.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "ros/source_pair.hpp"

namespace fpga_stereo {

/// Keeps every pair that was sent until its frame comes back. Pairs come back in the order in which
/// they were sent: a pair that is overtaken is lost. Not thread-safe.
class PairsInFlight {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMaxPairs = 4;
  static constexpr std::chrono::seconds kMinPatience{2};

  /// A pair that came back, and how many older ones are lost with that.
  struct Returned {
    SourcePair pair;
    std::uint64_t lost = 0;
  };

  bool is_empty() const { return pairs_.empty(); }
  bool is_full() const { return pairs_.size() >= kMaxPairs; }
  /// Returns the frame_id under which to send the next pair.
  std::uint64_t next_id() const { return next_id_; }
  /// Keeps a pair that was sent as next_id().
  void add(const SourcePair& pair, Clock::time_point now);
  /// Removes the pair sent as `frame_id` and all older ones. Returns nullopt if it was given up.
  std::optional<Returned> take(std::uint64_t frame_id, Clock::time_point now);
  /// Gives up all pairs if the board has returned none for kMaxPairs times its last turnaround.
  /// Returns how many it gave up.
  std::uint64_t give_up_late(Clock::time_point now);
  /// Removes and returns all pairs, the oldest first.
  std::vector<SourcePair> take_all();

 private:
  struct Sent {
    SourcePair pair;
    Clock::time_point when;
  };

  std::map<std::uint64_t, Sent> pairs_;  // by frame_id
  std::uint64_t next_id_ = 1;
  Clock::time_point last_return_{};
  Clock::duration turnaround_{std::chrono::seconds(10)};  // of the last returned pair
};

}  // namespace fpga_stereo
