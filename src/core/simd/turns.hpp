// Lets threads share work whose parts depend on each other in order.
#pragma once

#include "core/thread_safety.hpp"

namespace fpga_stereo::simd {

/// Hands out parts 0, 1, .. of a job. A thread that reaches the section in which parts depend on
/// each other waits until the part before has left it. A part is only handed out to a thread that
/// runs, so the part that others wait for always makes progress, whatever the number of threads.
class Turns {
 public:
  void start() {
    const MutexLock lock(mutex_);
    next_ = turn_ = 0;
  }
  /// Returns the next part.
  int claim() {
    const MutexLock lock(mutex_);
    return next_++;
  }
  /// Blocks until all parts before `part` have passed.
  void wait_for(int part) {
    const MutexLock lock(mutex_);
    while (turn_ != part) passed_.wait(mutex_);
  }
  /// Says that `part` has passed.
  void pass(int part) {
    {
      const MutexLock lock(mutex_);
      turn_ = part + 1;
    }
    passed_.notify_all();
  }

 private:
  Mutex mutex_;
  ConditionVariable passed_;
  int next_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  int turn_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
};

}  // namespace fpga_stereo::simd
