// Locks that Clang checks. -Wthread-safety verifies every FPGA_STEREO_GUARDED_BY and
// FPGA_STEREO_REQUIRES below at compile time; other compilers ignore them. libstdc++ does not
// annotate std::mutex, so code with guarded members uses the Mutex, MutexLock and ConditionVariable
// of this file.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

#if defined(__clang__)
#define FPGA_STEREO_THREAD_ATTRIBUTE(x) __attribute__((x))
#else
#define FPGA_STEREO_THREAD_ATTRIBUTE(x)
#endif

/// Marks a class as a lock; `name` appears in warnings.
#define FPGA_STEREO_CAPABILITY(name) FPGA_STEREO_THREAD_ATTRIBUTE(capability(name))
/// Marks a class whose lifetime holds a lock.
#define FPGA_STEREO_SCOPED_CAPABILITY FPGA_STEREO_THREAD_ATTRIBUTE(scoped_lockable)
/// Marks a member that may only be accessed while the given mutex is held.
#define FPGA_STEREO_GUARDED_BY(...) FPGA_STEREO_THREAD_ATTRIBUTE(guarded_by(__VA_ARGS__))
/// Marks a pointer whose target may only be accessed while the given mutex is held.
#define FPGA_STEREO_PT_GUARDED_BY(...) FPGA_STEREO_THREAD_ATTRIBUTE(pt_guarded_by(__VA_ARGS__))
/// Marks a function that its caller must call with the given mutexes held.
#define FPGA_STEREO_REQUIRES(...) FPGA_STEREO_THREAD_ATTRIBUTE(requires_capability(__VA_ARGS__))
/// Marks a function that its caller must call without the given mutexes: it locks them itself.
#define FPGA_STEREO_EXCLUDES(...) FPGA_STEREO_THREAD_ATTRIBUTE(locks_excluded(__VA_ARGS__))
/// Marks a function that locks the given mutexes and returns with them held.
#define FPGA_STEREO_ACQUIRE(...) FPGA_STEREO_THREAD_ATTRIBUTE(acquire_capability(__VA_ARGS__))
/// Marks a function that unlocks the given mutexes.
#define FPGA_STEREO_RELEASE(...) FPGA_STEREO_THREAD_ATTRIBUTE(release_capability(__VA_ARGS__))
/// Marks a mutex that a thread locks after the given ones, if it holds both.
#define FPGA_STEREO_ACQUIRED_AFTER(...) FPGA_STEREO_THREAD_ATTRIBUTE(acquired_after(__VA_ARGS__))
/// Marks a mutex that a thread locks before the given ones, if it holds both.
#define FPGA_STEREO_ACQUIRED_BEFORE(...) FPGA_STEREO_THREAD_ATTRIBUTE(acquired_before(__VA_ARGS__))
/// Switches the analysis off for one function. Give the reason in a comment.
#define FPGA_STEREO_NO_THREAD_SAFETY_ANALYSIS \
  FPGA_STEREO_THREAD_ATTRIBUTE(no_thread_safety_analysis)

namespace fpga_stereo {

/// A std::mutex that Clang's analysis knows.
class FPGA_STEREO_CAPABILITY("mutex") Mutex {
 public:
  Mutex() = default;
  Mutex(const Mutex&) = delete;
  Mutex& operator=(const Mutex&) = delete;

  void lock() FPGA_STEREO_ACQUIRE() { mutex_.lock(); }
  void unlock() FPGA_STEREO_RELEASE() { mutex_.unlock(); }

 private:
  friend class ConditionVariable;
  std::mutex mutex_;
};

/// Holds a mutex until the end of its scope, as std::lock_guard does. unlock() and lock() interrupt
/// that; the lock must be held again, or stay released, on every path to the end of the scope.
class FPGA_STEREO_SCOPED_CAPABILITY MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) FPGA_STEREO_ACQUIRE(mutex) : mutex_(mutex) { mutex_.lock(); }
  ~MutexLock() FPGA_STEREO_RELEASE() {
    if (is_held_) mutex_.unlock();
  }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

  void unlock() FPGA_STEREO_RELEASE() {
    mutex_.unlock();
    is_held_ = false;
  }
  void lock() FPGA_STEREO_ACQUIRE() {
    mutex_.lock();
    is_held_ = true;
  }

 private:
  Mutex& mutex_;
  bool is_held_ = true;
};

/// A std::condition_variable for a Mutex. It takes no predicate, because the analysis does not
/// follow a lock into a lambda; write the loop:
///
///   while (!is_ready_) {
///     if (!changed_.wait_until(mutex_, deadline)) break;  // timed out
///   }
class ConditionVariable {
 public:
  /// Releases the mutex, blocks until notified (or spuriously), and locks it again.
  void wait(Mutex& mutex) FPGA_STEREO_REQUIRES(mutex) {
    std::unique_lock<std::mutex> lock(mutex.mutex_, std::adopt_lock);
    condition_.wait(lock);
    lock.release();
  }
  /// As wait(), until `deadline` at the latest. Returns false once that has passed.
  template <class Clock, class Duration>
  bool wait_until(Mutex& mutex, const std::chrono::time_point<Clock, Duration>& deadline)
      FPGA_STEREO_REQUIRES(mutex) {
    std::unique_lock<std::mutex> lock(mutex.mutex_, std::adopt_lock);
    const std::cv_status status = condition_.wait_until(lock, deadline);
    lock.release();
    return status == std::cv_status::no_timeout;
  }
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

 private:
  std::condition_variable condition_;
};

}  // namespace fpga_stereo
