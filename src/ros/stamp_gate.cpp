#include "ros/stamp_gate.hpp"

#include <fmt/format.h>

namespace fpga_stereo {

Result<std::uint64_t> StampGate::accept(const ros::Time& stamp) {
  const MutexLock lock(mutex_);
  if (stamp.isZero()) {
    return Error{ErrorKind::kInvalid,
                 "its stamp is 0; the camera driver must set it (with use_sim_time, a node must "
                 "publish /clock)"};
  }
  if (stamp <= last_accepted_) {
    const bool rises = rising_refusals_ > 0 && stamp > last_refused_;
    rising_refusals_ = rises ? rising_refusals_ + 1 : 1;
    last_refused_ = stamp;
    if (rising_refusals_ < kRestartAfter) {
      return Error{ErrorKind::kInvalid,
                   fmt::format("its stamp {:.3f} is not later than {:.3f}, the stamp of the "
                               "previous pair",
                               stamp.toSec(), last_accepted_.toSec())};
    }
  }
  last_accepted_ = stamp;
  rising_refusals_ = 0;
  return ++count_;
}

}  // namespace fpga_stereo
