// Checks the stamps of incoming pairs.
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <string>

#include "core/log_limiter.hpp"
#include "core/thread_safety.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Accepts pairs whose stamps rise; a pair that is not later than the last accepted one is late or
/// a duplicate. Thread-safe.
class StampGate {
 public:
  /// Returns the number of the accepted pair: it rises from pair to pair, even if time starts over.
  /// Refuses late pairs and stamps of 0.
  Result<std::uint64_t> accept(const ros::Time& stamp) FPGA_STEREO_EXCLUDES(mutex_);
  /// Call when time itself has moved back: the next pair may have any stamp. Logs `why`, for
  /// example "the stamps moved back from 12.000 to 2.000 s".
  void restart(const std::string& why) FPGA_STEREO_EXCLUDES(mutex_);

 private:
  Mutex mutex_;
  ros::Time last_accepted_ FPGA_STEREO_GUARDED_BY(mutex_);  // 0: none
  std::uint64_t count_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  LogLimiter log_ FPGA_STEREO_GUARDED_BY(mutex_);
};

}  // namespace fpga_stereo
