#include "ros/verifier.hpp"

#include <ros/console.h>

#include <utility>
#include <vector>

namespace fpga_stereo {

Verifier::Verifier(std::uint64_t interval) : interval_(interval), thread_([this] { run(); }) {}

Verifier::~Verifier() {
  {
    const MutexLock lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Verifier::offer(std::uint64_t frame_id, const Job& job) {
  {
    const MutexLock lock(mutex_);
    if (interval_ == 0 || (last_offered_ && frame_id - *last_offered_ < interval_)) return;
    last_offered_ = frame_id;
    if (waiting_) return;
    waiting_ = job;
  }
  wake_.notify_one();
}

Verifier::Counters Verifier::counters() const {
  const MutexLock lock(mutex_);
  return counters_;
}

std::optional<Verifier::Job> Verifier::wait_for_job() {
  const MutexLock lock(mutex_);
  while (!is_stopping_ && !waiting_) wake_.wait(mutex_);
  if (is_stopping_) return std::nullopt;
  return std::exchange(waiting_, std::nullopt);
}

void Verifier::run() {
  Pipeline pipeline;
  while (const std::optional<Job> job = wait_for_job()) {
    const DisparityFrame& computed = pipeline.process(job->pair.raw.left, job->pair.raw.right,
                                                      *job->rectification, job->parameters, 1);
    std::vector<cv::Point> differ;
    cv::findNonZero(computed.disparity != job->disparity, differ);
    if (!differ.empty()) {
      ROS_ERROR_NAMED("stereo",
                      "the board's disparity differs from the software's in %zu pixels; first at "
                      "x %d, y %d: the board has %d, the software %d",
                      differ.size(), differ[0].x, differ[0].y, job->disparity(differ[0]),
                      computed.disparity(differ[0]));
    }
    const MutexLock lock(mutex_);
    ++counters_.frames;
    counters_.pixels_differ += differ.size();
  }
}

}  // namespace fpga_stereo
