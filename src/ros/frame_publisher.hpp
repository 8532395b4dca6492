// Publishes the frames of all sources in order.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <utility>

#include "core/thread_safety.hpp"
#include "ros/health.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// Frames come from the software's thread and from the board's. Only one of them publishes at a
/// time, and it holds no lock meanwhile: a thread that finds the other one publishing leaves its
/// frame in a queue, and the other thread publishes it next.
class FramePublisher {
 public:
  /// Frames in the queue, at most; another frame then replaces the oldest.
  static constexpr std::size_t kMaxQueued = 2;

  using Publish = std::function<void(const StereoFrame&)>;

  /// `publish` writes one frame to all outputs; it is called by one thread at a time.
  FramePublisher(Publish publish, Health& health) : publish_(std::move(publish)), health_(health) {}

  /// Publishes the frame, or queues a copy of it for the thread that is publishing. Drops a frame
  /// whose successor is published already. Any thread.
  void publish(const StereoFrame& frame) FPGA_STEREO_EXCLUDES(mutex_);

 private:
  /// Only for the thread that has set is_publishing_.
  void publish_now(const StereoFrame& frame);

  const Publish publish_;
  Health& health_;

  Mutex mutex_;
  bool is_publishing_ FPGA_STEREO_GUARDED_BY(mutex_) = false;
  std::deque<StereoFrame> queue_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::uint64_t last_number_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;  // of the last published pair
};

}  // namespace fpga_stereo
