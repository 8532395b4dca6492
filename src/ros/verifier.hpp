// Computes some of the board's frames again in software. Every pixel must be the same.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <thread>

#include "core/thread_safety.hpp"
#include "fpga_stereo/core/pipeline.hpp"
#include "ros/source_pair.hpp"

namespace fpga_stereo {

/// One thread computes; a frame that is offered while it is busy is not verified. Thread-safe.
class Verifier {
 public:
  struct Job {
    SourcePair pair;
    cv::Mat1w disparity;  // of the board
    std::shared_ptr<const StereoRectification> rectification;
    Parameters parameters;
  };
  struct Counters {
    std::uint64_t frames = 0, pixels_differ = 0;
  };

  /// `interval`: verify frames whose frame_ids are this far apart or further; 0: none.
  explicit Verifier(std::uint64_t interval);
  ~Verifier();
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  /// Verifies the frame if it is due. Shares the pixels of the job.
  void offer(std::uint64_t frame_id, const Job& job) FPGA_STEREO_EXCLUDES(mutex_);
  Counters counters() const FPGA_STEREO_EXCLUDES(mutex_);

 private:
  void run() FPGA_STEREO_EXCLUDES(mutex_);
  /// Blocks until a job waits; returns nullopt when the verifier is being destroyed.
  std::optional<Job> wait_for_job() FPGA_STEREO_EXCLUDES(mutex_);

  const std::uint64_t interval_;
  mutable Mutex mutex_;
  ConditionVariable wake_;
  std::optional<std::uint64_t> last_offered_ FPGA_STEREO_GUARDED_BY(mutex_);  // frame_id
  std::optional<Job> waiting_ FPGA_STEREO_GUARDED_BY(mutex_);
  Counters counters_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_stopping_ FPGA_STEREO_GUARDED_BY(mutex_) = false;

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace fpga_stereo
