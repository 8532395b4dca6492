// From the board's clock to the host's, by round trips.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace fpga_stereo::link {

/// Each answer of a board has the time at which it was sent. Where a round trip was short, that was
/// in the middle of it, to half of its length. A line is fitted over the last samples: a board's
/// clock drifts by tens of us per second.
class TimeSync {
 public:
  static constexpr double kLongestHalf = 0.005;  // s: half of a round trip that is taken
  static constexpr std::size_t kSamples = 120;   // one each half second: a minute
  static constexpr double kMaxDrift = 1e-3;      // s per s; more is no clock

  /// The request left at `sent` and its answer came at `received`, s, host; the board sent it at
  /// `board_us`. False: the round trip took too long, or is none.
  bool add(double sent, std::uint64_t board_us, double received);

  /// The host's time, s, of a time of the board, once there is a sample. A later time of the board
  /// never gives an earlier one of the host than was given before.
  std::optional<double> to_host(std::uint64_t board_us);

  /// How much faster than the host's the board's clock runs, s per s.
  double drift() const { return 1 / slope_ - 1; }
  /// Half of the shortest round trip so far, s: what a stamp may be off by.
  double uncertainty() const { return shortest_half_; }
  std::size_t samples() const { return samples_.size(); }

  /// The board was reset: what is known about its clock is of no use.
  void reset();

 private:
  struct Sample {
    double board, host;  // s, since the reference
  };
  double since_reference(std::uint64_t board_us) const;
  void fit();

  std::deque<Sample> samples_;
  std::uint64_t board_reference_ = 0;  // us
  double host_reference_ = 0;          // s
  double slope_ = 1, offset_ = 0;
  double shortest_half_ = kLongestHalf;
  double given_board_ = 0, given_host_ = 0;  // the latest that was given
  bool given_ = false;
};

}  // namespace fpga_stereo::link
