// Computes frames of the board again, in software: every pixel must be the same.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <thread>

#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo {

/// One thread of its own; a frame that comes while it is busy is left out.
class Verifier {
 public:
  struct Job {
    cv::Mat1b left, right;  // raw
    cv::Mat1w disparity;    // of the board
    std::shared_ptr<const StereoRectification> rectification;
    Parameters parameters;
  };
  struct Counters {
    std::uint64_t frames = 0, pixels_differ = 0;
  };

  Verifier();
  ~Verifier();
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  void offer(Job job);
  Counters counters() const;

 private:
  void run();

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Job> waiting_;
  Counters counters_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace fpga_stereo
