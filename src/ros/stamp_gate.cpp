#include "ros/stamp_gate.hpp"

#include <fmt/format.h>
#include <ros/console.h>

#include <optional>

namespace fpga_stereo {

Result<std::uint64_t> StampGate::accept(const ros::Time& stamp) {
  const MutexLock lock(mutex_);
  if (stamp.isZero()) {
    return Error{ErrorKind::kInvalid,
                 "its stamp is 0; the camera driver must set it (with use_sim_time, a node must "
                 "publish /clock)"};
  }
  if (stamp <= last_accepted_) {
    return Error{ErrorKind::kInvalid,
                 fmt::format("its stamp {:.3f} is not later than {:.3f}, the stamp of the previous "
                             "pair",
                             stamp.toSec(), last_accepted_.toSec())};
  }
  last_accepted_ = stamp;
  return ++count_;
}

void StampGate::restart(const std::string& why) {
  std::optional<std::uint64_t> kept_back;
  {
    const MutexLock lock(mutex_);
    last_accepted_ = {};
    kept_back = log_.admit("restart");
  }
  if (!kept_back) return;
  ROS_INFO_STREAM_NAMED("stereo", with_kept_back("time starts over: " + why, *kept_back));
}

}  // namespace fpga_stereo
