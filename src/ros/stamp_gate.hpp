// Lets frames through in the order of their stamps.
#pragma once

#include <ros/time.h>

#include <optional>
#include <string>

namespace fpga_stereo {

/// A frame that is not later than the one before is late or doubled and is refused. A source that
/// starts over (a bag played again) sends several in a row that are in order among themselves: then
/// time has moved back, and the gate opens for them.
class StampGate {
 public:
  static constexpr int kRestartAfter = 3;  // frames in order among themselves

  /// Why the frame is refused, or nothing where it may pass.
  std::optional<std::string> check(const ros::Time& stamp);

 private:
  ros::Time passed_;   // the last stamp let through
  ros::Time refused_;  // the last stamp refused
  int refused_in_order_ = 0;
};

}  // namespace fpga_stereo
