// Makes frames with the software pipeline.
#pragma once

#include <functional>
#include <optional>
#include <thread>

#include "core/thread_safety.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/core/rectification_cache.hpp"
#include "ros/demand.hpp"
#include "ros/health.hpp"
#include "ros/rectification_log.hpp"
#include "ros/source_pair.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// One thread computes frames and hands them on. At most one pair waits for it: a newer pair
/// replaces the waiting one, so that latency stays bounded.
class SoftwareSource {
 public:
  using Callback = std::function<void(const StereoFrame&)>;

  /// Calls `callback` from the source's own thread, without a lock. `health` must outlive the
  /// source.
  SoftwareSource(Health& health, Callback callback);
  ~SoftwareSource();
  SoftwareSource(const SoftwareSource&) = delete;
  SoftwareSource& operator=(const SoftwareSource&) = delete;

  /// Takes a pair. Any thread.
  void receive(const SourcePair& pair) FPGA_STEREO_EXCLUDES(mutex_);
  /// Drops the waiting pair.
  void drop_waiting() FPGA_STEREO_EXCLUDES(mutex_);
  /// Sets what the next frame contains.
  void set_demand(const Demand& demand) FPGA_STEREO_EXCLUDES(mutex_);
  void set_settings(const Settings& settings) FPGA_STEREO_EXCLUDES(mutex_);

 private:
  struct Job {
    SourcePair pair;
    Demand demand;
    Settings settings;
  };

  void run() FPGA_STEREO_EXCLUDES(mutex_);
  /// Blocks until a pair waits; returns nullopt when the source is being destroyed.
  std::optional<Job> wait_for_job() FPGA_STEREO_EXCLUDES(mutex_);
  Result<StereoFrame> make_frame(const Job& job);

  Health& health_;
  const Callback callback_;

  // Used by the source's thread alone.
  Pipeline pipeline_;
  RectificationCache rectifications_;
  RectificationLog log_;

  Mutex mutex_;
  ConditionVariable wake_;
  std::optional<SourcePair> waiting_ FPGA_STEREO_GUARDED_BY(mutex_);
  Demand demand_ FPGA_STEREO_GUARDED_BY(mutex_);
  Settings settings_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_stopping_ FPGA_STEREO_GUARDED_BY(mutex_) = false;

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace fpga_stereo
