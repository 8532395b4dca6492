// Checks the stamps of incoming pairs.
#pragma once

#include <ros/time.h>

#include <cstdint>

#include "core/thread_safety.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Accepts pairs whose stamps rise; a pair that is not later than the last accepted one is late or
/// a duplicate. If a source starts over (a bag played again), several late pairs in a row rise
/// among themselves: the gate then follows the new time. Thread-safe.
class StampGate {
 public:
  static constexpr int kRestartAfter = 3;  // rising late stamps that mean a new start

  /// Returns the number of the accepted pair: it rises from pair to pair, even if time starts over.
  /// Refuses late pairs and stamps of 0.
  Result<std::uint64_t> accept(const ros::Time& stamp) FPGA_STEREO_EXCLUDES(mutex_);

 private:
  Mutex mutex_;
  ros::Time last_accepted_ FPGA_STEREO_GUARDED_BY(mutex_);
  ros::Time last_refused_ FPGA_STEREO_GUARDED_BY(mutex_);
  int rising_refusals_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  std::uint64_t count_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
};

}  // namespace fpga_stereo
