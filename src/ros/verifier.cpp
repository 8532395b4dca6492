#include "ros/verifier.hpp"

#include <ros/console.h>

#include <utility>
#include <vector>

namespace fpga_stereo {

Verifier::Verifier() : thread_([this] { run(); }) {}

Verifier::~Verifier() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void Verifier::offer(Job job) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_) return;
    waiting_ = std::move(job);
  }
  wake_.notify_one();
}

Verifier::Counters Verifier::counters() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counters_;
}

void Verifier::run() {
  Pipeline pipeline;
  while (true) {
    Job job;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
      if (stopping_) return;
      job = std::move(*waiting_);
      waiting_.reset();
    }
    const DisparityFrame& made =
        pipeline.process(job.left, job.right, *job.rectification, job.parameters, 1);
    std::vector<cv::Point> differ;
    cv::findNonZero(made.disparity != job.disparity, differ);
    if (!differ.empty()) {
      ROS_ERROR_NAMED("stereo",
                      "the board's disparity differs from the software's in %zu pixels, first at "
                      "x %d, y %d: %d instead of %d",
                      differ.size(), differ[0].x, differ[0].y, job.disparity(differ[0]),
                      made.disparity(differ[0]));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    ++counters_.frames;
    counters_.pixels_differ += differ.size();
  }
}

}  // namespace fpga_stereo
