#include "ros/software_source.hpp"

#include <utility>

#include "ros/make_frame.hpp"

namespace fpga_stereo {

SoftwareSource::SoftwareSource(Health& health, Callback callback)
    : health_(health), callback_(std::move(callback)), thread_([this] { run(); }) {}

SoftwareSource::~SoftwareSource() {
  {
    const MutexLock lock(mutex_);
    is_stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void SoftwareSource::drop_waiting() {
  const MutexLock lock(mutex_);
  if (waiting_) health_.dropped(DropCause::kUnwanted);
  waiting_.reset();
}

void SoftwareSource::set_demand(const Demand& demand) {
  const MutexLock lock(mutex_);
  demand_ = demand;
}

void SoftwareSource::set_settings(const Settings& settings) {
  const MutexLock lock(mutex_);
  settings_ = settings;
}

void SoftwareSource::receive(const SourcePair& pair) {
  {
    const MutexLock lock(mutex_);
    if (waiting_) health_.dropped(DropCause::kReplaced);
    // Pairs that a board gives back may be older than one that came from the topics meanwhile.
    if (!waiting_ || pair.number > waiting_->number) waiting_ = pair;
  }
  wake_.notify_one();
}

std::optional<SoftwareSource::Job> SoftwareSource::wait_for_job() {
  const MutexLock lock(mutex_);
  while (!is_stopping_ && !waiting_) wake_.wait(mutex_);
  if (is_stopping_) return std::nullopt;
  Job job{std::move(*waiting_), demand_, settings_};
  waiting_.reset();
  return job;
}

void SoftwareSource::run() {
  while (const std::optional<Job> job = wait_for_job()) {
    if (!job->demand.needs_pairs()) {
      health_.dropped(DropCause::kUnwanted);
    } else if (const Result<StereoFrame> frame = make_frame(*job); frame) {
      callback_(*frame);
    } else {
      health_.refused(cause_of(frame.error().kind), frame.error().message);
    }
  }
}

Result<StereoFrame> SoftwareSource::make_frame(const Job& job) {
  const RawPair& raw = job.pair.raw;
  const Parameters& parameters = job.settings.pipeline;
  const auto& cached = rectifications_.get(raw.calibration, parameters.min_disparity);
  if (!cached) return cached.error();
  const StereoRectification& rectification = **cached;
  log_.note(rectification);
  if (const Status size = check_pair_size(raw, rectification); !size) return size.error();

  StereoFrame frame = make_empty_frame(job.pair, job.settings);
  frame.geometry = rectification.geometry;
  if (job.demand.disparity) {
    const DisparityFrame& computed =
        pipeline_.process(raw.left, raw.right, rectification, parameters, job.settings.num_threads);
    frame.disparity = computed.disparity;
    frame.left.rect = computed.left;
    // Others expect a right image that is not shifted by min_disparity.
    if (parameters.min_disparity == 0) frame.right.rect = computed.right;
    frame.ms = computed.ms;
  }
  add_rectified_images(raw, rectification, job.demand, frame);
  return frame;
}

}  // namespace fpga_stereo
