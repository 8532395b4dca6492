// The stamps of recorded frames.
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <optional>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Moves recorded frames into the present: the first gets the time when it is played, the others
/// follow in the recorded intervals. One thread at a time.
class ReplayClock {
 public:
  /// Returns the stamp of a frame with this board time, which is played at `now`, and `speed` times
  /// as fast as it was recorded; 0: as fast as possible, so that every frame gets `now`. Begins
  /// anew if board time goes back: the board was reset. Refuses what ros::Time cannot represent.
  Result<ros::Time> stamp(std::uint64_t board_us, double speed, const ros::Time& now);

 private:
  std::optional<std::uint64_t> first_us_;
  std::uint64_t last_us_ = 0;
  ros::Time first_stamp_;
};

}  // namespace fpga_stereo
