#include "ros/replay_clock.hpp"

#include <fmt/format.h>

#include <limits>

namespace fpga_stereo {

Result<ros::Time> ReplayClock::stamp(std::uint64_t board_us, double speed, const ros::Time& now) {
  constexpr double kMaxSeconds = std::numeric_limits<std::uint32_t>::max();
  if (!first_us_ || speed <= 0 || board_us < last_us_) {
    first_us_ = board_us;
    first_stamp_ = now;
  }
  last_us_ = board_us;
  if (board_us == *first_us_) return first_stamp_;
  const double passed = static_cast<double>(board_us - *first_us_) * 1e-6 / speed;
  if (!(first_stamp_.toSec() + passed < kMaxSeconds)) {
    return Error{
        ErrorKind::kInvalid,
        fmt::format("its board time is {:.0f} s after the first one: allowed are stamps of "
                    "up to {} s",
                    passed, kMaxSeconds)};
  }
  ros::Time stamp;
  stamp.fromNSec(first_stamp_.toNSec() + static_cast<std::uint64_t>(passed * 1e9));
  return stamp;
}

}  // namespace fpga_stereo
