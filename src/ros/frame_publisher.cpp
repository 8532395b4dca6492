#include "ros/frame_publisher.hpp"

#include <ros/time.h>

#include <utility>

namespace fpga_stereo {

void FramePublisher::publish(const StereoFrame& frame) {
  {
    const MutexLock lock(mutex_);
    if (is_publishing_) {
      if (queue_.size() == kMaxQueued) {
        queue_.pop_front();
        health_.dropped(DropCause::kReplaced);
      }
      queue_.push_back(frame);
      queue_.back().own_pixels();
      return;
    }
    if (frame.number <= last_number_) return health_.dropped(DropCause::kReplaced);
    last_number_ = frame.number;
    is_publishing_ = true;
  }
  publish_now(frame);
  while (true) {
    StereoFrame next;
    {
      const MutexLock lock(mutex_);
      if (queue_.empty()) {
        is_publishing_ = false;
        return;
      }
      next = std::move(queue_.front());
      queue_.pop_front();
      if (next.number <= last_number_) {
        health_.dropped(DropCause::kReplaced);
        continue;
      }
      last_number_ = next.number;
    }
    publish_now(next);
  }
}

void FramePublisher::publish_now(const StereoFrame& frame) {
  const ros::WallTime start = ros::WallTime::now();
  publish_(frame);
  const double publish_ms = (ros::WallTime::now() - start).toSec() * 1e3;
  const double latency_ms = (ros::Time::now() - frame.left.header.stamp).toSec() * 1e3;
  health_.published(frame.ms, publish_ms, latency_ms);
  if (frame.arrived > 0) {
    health_.link_latency((ros::WallTime::now().toSec() - frame.arrived) * 1e3);
  }
}

}  // namespace fpga_stereo
