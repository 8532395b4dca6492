// Converts the board's time to that of the host's steady clock, by round trips.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

namespace fpga_stereo::link {

/// Each answer of a board holds the time at which it was sent. In a short round trip that is the
/// middle, give or take half of the round trip. A straight line is fitted to the last samples,
/// because a board's clock drifts by tens of us per second. A sample far from the line means that
/// the board's clock was set, or the host was suspended: a new line begins with it.
class TimeSync {
 public:
  static constexpr double kMaxHalf = 0.005;        // s: half of the longest round trip used
  static constexpr std::size_t kMaxSamples = 120;  // one per half second: a minute
  static constexpr double kMaxDrift = 1e-3;        // s per s: more is an error, not drift
  static constexpr double kMaxError = 0.02;        // s: of a sample; more is a step of the clock

  /// Adds a round trip: the request left at `sent` and its answer arrived at `received`, s, host;
  /// the board sent the answer at `board_us`. Returns false, without using it, if it took too long
  /// or the times are impossible.
  bool add(double sent, std::uint64_t board_us, double received);

  /// Returns the host's time, s, of a time of the board; nullopt without a sample. The result never
  /// runs backwards while the board's time does not, except where the board's clock has stepped.
  std::optional<double> to_host(std::uint64_t board_us);

  /// Returns how often the board's clock has stepped.
  std::uint64_t steps() const { return steps_; }
  /// Returns false while the clock steps again and again: it does not run at the host's rate.
  bool is_steady() const { return strikes_ < kMaxStrikes; }

  /// Returns how much faster than the host's clock the board's clock runs, s per s.
  double drift() const { return 1 / slope_ - 1; }
  /// Returns half of the shortest round trip so far, s: the error bound of stamps.
  double uncertainty() const { return shortest_half_; }
  std::size_t samples() const { return samples_.size(); }

  /// Forgets the board's clock, because the board was reset or replaced.
  void reset();

 private:
  struct Sample {
    double board, host;  // s, since the reference
  };
  double since_reference(std::uint64_t board_us) const;
  void fit();
  void restart();

  // A step counts as ten strikes, a sample on the line as one less.
  static constexpr int kStrikesOfStep = 10, kMaxStrikes = 20;

  std::deque<Sample> samples_;
  std::uint64_t board_reference_ = 0;  // us
  double host_reference_ = 0;          // s
  double slope_ = 1, offset_ = 0;
  double shortest_half_ = kMaxHalf;
  double last_board_ = 0, last_host_ = 0;  // the latest result
  bool has_last_ = false;
  std::uint64_t steps_ = 0;
  int strikes_ = 0;
};

}  // namespace fpga_stereo::link
