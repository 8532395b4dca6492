#include "ros/stamp_gate.hpp"

#include <iomanip>
#include <sstream>

namespace fpga_stereo {

std::optional<std::string> StampGate::check(const ros::Time& stamp) {
  if (stamp.isZero()) {
    return "its stamp is 0: the camera driver must set it (with use_sim_time somebody must "
           "publish /clock)";
  }
  if (stamp > passed_) {
    passed_ = stamp;
    refused_in_order_ = 0;
    return std::nullopt;
  }
  refused_in_order_ = refused_in_order_ > 0 && stamp > refused_ ? refused_in_order_ + 1 : 1;
  refused_ = stamp;
  if (refused_in_order_ >= kRestartAfter) {
    passed_ = stamp;
    refused_in_order_ = 0;
    return std::nullopt;
  }
  std::ostringstream why;
  why << std::fixed << std::setprecision(3) << "its stamp " << stamp.toSec()
      << " is not later than that of the frame before, " << passed_.toSec();
  return why.str();
}

}  // namespace fpga_stereo
