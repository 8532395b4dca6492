#include "ros/software_source.hpp"

#include <ros/console.h>

#include <utility>

#include "ros/make_frame.hpp"

namespace fpga_stereo {
SoftwareSource::SoftwareSource(Health& health, Callback callback)
    : health_(health), callback_(std::move(callback)), thread_([this] { run(); }) {}

SoftwareSource::~SoftwareSource() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void SoftwareSource::forget() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (waiting_) health_.dropped(DropCause::kUnwanted);
  waiting_.reset();
}

void SoftwareSource::set_demand(const Demand& demand) {
  const std::lock_guard<std::mutex> lock(mutex_);
  demand_ = demand;
}

void SoftwareSource::set_settings(const Settings& settings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  settings_ = settings;
}

void SoftwareSource::receive(const InputPair& pair) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_) health_.dropped(DropCause::kReplaced);
    waiting_ = pair;
  }
  wake_.notify_one();
}

void SoftwareSource::run() {
  while (true) {
    InputPair pair;
    Demand demand;
    Settings settings;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return stopping_ || waiting_.has_value(); });
      if (stopping_) return;
      pair = std::move(*waiting_);
      waiting_.reset();
      demand = demand_;
      settings = settings_;
    }
    if (!demand.any()) {
      health_.dropped(DropCause::kUnwanted);
    } else if (const Result<StereoFrame> frame = make(pair, demand, settings); frame) {
      callback_(*frame);
    } else {
      refuse(cause_of(frame.error().kind), frame.error().message);
    }
  }
}

void SoftwareSource::refuse(DropCause cause, const std::string& why) {
  // Once per reason, not once per frame.
  if (health_.refusal() != why) ROS_ERROR_STREAM_NAMED("stereo", why);
  health_.refused(cause, why);
}

Result<StereoFrame> SoftwareSource::make(const InputPair& pair, const Demand& demand,
                                         const Settings& settings) {
  const auto& made = rectifier_(*pair.left_info, *pair.right_info, settings.pipeline.min_disparity);
  if (!made) return made.error();
  auto begun = begin_frame(pair, **made, settings);
  if (!begun) return begun.error();
  StereoFrame& frame = *begun;
  if (demand.disparity) {
    const DisparityFrame& computed = pipeline_.process(frame.left.mono, frame.right.mono, **made,
                                                       settings.pipeline, settings.num_threads);
    frame.disparity = computed.disparity;
    frame.left.rect = computed.left;
    if (settings.pipeline.min_disparity == 0) frame.right.rect = computed.right;
    frame.ms = computed.ms;
  }
  if (const Status added = add_pictures(pair, **made, demand, frame); !added) return added.error();
  return begun;
}

}  // namespace fpga_stereo
