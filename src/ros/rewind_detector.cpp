#include "ros/rewind_detector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace fpga_stereo {
namespace {

std::string moved_back(const char* what, const ros::Time& from, const ros::Time& to) {
  return fmt::format("{} moved back from {:.3f} to {:.3f} s", what, from.toSec(), to.toSec());
}

}  // namespace

bool RewindDetector::is_unexplained(const ros::Time& stamp) const {
  if (stamps_.empty()) return false;
  const bool is_repeated = std::find(stamps_.begin(), stamps_.end(), stamp) != stamps_.end();
  const auto places = std::count_if(stamps_.begin(), stamps_.end(),
                                    [&](const ros::Time& other) { return other > stamp; });
  const ros::Time latest = *std::max_element(stamps_.begin(), stamps_.end());
  return is_repeated || places >= kMaxPlaces || (latest - stamp).toSec() > kMaxLateness;
}

std::optional<std::string> RewindDetector::note(const ros::Time& stamp,
                                                const std::optional<ros::Time>& simulated_now) {
  const auto last_now = std::exchange(simulated_now_, simulated_now);
  if (stamp.isZero()) return std::nullopt;  // means that there is no stamp
  std::optional<std::string> rewind;
  std::deque<ros::Time> new_time;  // the messages before this one that belong to it
  if (last_now && simulated_now && *simulated_now < *last_now) {
    rewind = moved_back("simulated time", *last_now, *simulated_now);
  } else if (!is_unexplained(stamp)) {
    unexplained_.reset();
  } else if (const auto last = std::exchange(unexplained_, stamp); last && stamp > *last) {
    rewind = moved_back("the stamps", *std::max_element(stamps_.begin(), stamps_.end()), stamp);
    new_time = {*last};
  }
  if (rewind) {
    stamps_ = std::move(new_time);
    unexplained_.reset();
  }
  stamps_.push_back(stamp);
  if (stamps_.size() > kRemembered) stamps_.pop_front();
  return rewind;
}

}  // namespace fpga_stereo
