#include "ros/health.hpp"

#include <fmt/format.h>
#include <ros/console.h>

#include <algorithm>

namespace fpga_stereo {

DropCause cause_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUncalibrated:
      return DropCause::kUncalibrated;
    case ErrorKind::kCalibration:
      return DropCause::kCalibration;
    case ErrorKind::kImageSize:
      return DropCause::kImageSize;
    default:
      break;
  }
  return DropCause::kEncoding;
}

void Health::received() {
  const MutexLock lock(mutex_);
  ++in_;
}

void Health::dropped(DropCause cause, std::uint64_t frames) {
  const MutexLock lock(mutex_);
  dropped_[static_cast<std::size_t>(cause)] += frames;
}

void Health::refused(DropCause cause, const std::string& text) {
  refused(cause, {kDropCauses[static_cast<std::size_t>(cause)].state, text});
}

void Health::refused(DropCause cause, const StateReport& report) {
  std::optional<std::uint64_t> kept_back;
  {
    const MutexLock lock(mutex_);
    ++dropped_[static_cast<std::size_t>(cause)];
    refusal_ = report;
    kept_back =
        log_.admit(fmt::format("{}, state {}", kDropCauses[static_cast<std::size_t>(cause)].name,
                               static_cast<int>(report.state)));
  }
  if (!kept_back) return;
  const std::string line = with_kept_back(report.text, *kept_back);
  if (severity(report.state) == Severity::kError) {
    ROS_ERROR_STREAM_NAMED("stereo", line);
  } else {
    ROS_WARN_STREAM_NAMED("stereo", line);
  }
}

void Health::published(const StageTimes& stages, double publish_ms, double latency_ms) {
  const MutexLock lock(mutex_);
  ++published_;
  ++frames_;
  has_published_ = has_subscribers_;
  refusal_.reset();
  for (std::size_t i = 0; i < stages.size(); ++i) stage_ms_[i] += stages[i];
  publish_ms_ += publish_ms;
  latency_ms_ += latency_ms;
}

void Health::link_latency(double ms) {
  const MutexLock lock(mutex_);
  constexpr std::size_t kMaxLatencies = 10000;  // in case nobody reads the status
  if (link_latency_ms_.size() < kMaxLatencies) link_latency_ms_.push_back(ms);
}

void Health::set_has_subscribers(bool has_subscribers) {
  const MutexLock lock(mutex_);
  if (!has_subscribers) {
    has_published_ = false;
    refusal_.reset();  // it would mislead the next subscriber
  }
  has_subscribers_ = has_subscribers;
}

void Health::expect_first_frame() {
  const MutexLock lock(mutex_);
  has_published_ = false;
}

StereoStatus Health::report(bool restart) {
  const MutexLock lock(mutex_);
  StereoStatus s;
  s.frames_in = in_;
  s.frames_published = published_;
  for (std::size_t cause = 0; cause < dropped_.size(); ++cause) {
    s.*kDropCauses[cause].field = dropped_[cause];
  }

  const ros::WallTime now = ros::WallTime::now();
  if (frames_ > 0) {
    const auto n = static_cast<double>(frames_);
    const auto mean = [&](double sum) { return static_cast<float>(sum / n); };
    const StageTimes sums = stage_ms_;
    const auto stage = [&](Stage which) { return mean(sums[static_cast<std::size_t>(which)]); };
    s.rate = static_cast<float>(n / std::max((now - interval_start_).toSec(), 1e-3));
    s.latency_ms = mean(latency_ms_);
    s.rectify_ms = stage(Stage::kRectify);
    s.census_ms = stage(Stage::kCensus);
    s.match_ms = stage(Stage::kMatch);
    s.cost_ms = stage(Stage::kCost);
    s.aggregate_ms = stage(Stage::kAggregate);
    s.select_ms = stage(Stage::kSelect);
    s.check_ms = stage(Stage::kCheck);
    s.subpixel_ms = stage(Stage::kSubpixel);
    s.speckle_ms = stage(Stage::kSpeckle);
    s.fill_ms = stage(Stage::kFill);
    s.median_ms = stage(Stage::kMedian);
    s.publish_ms = mean(publish_ms_);
  }
  if (!link_latency_ms_.empty()) {
    std::vector<double> sorted = link_latency_ms_;
    std::sort(sorted.begin(), sorted.end());
    const auto percentile = [&](std::size_t percent) {  // nearest rank
      return static_cast<float>(sorted[(percent * sorted.size() + 99) / 100 - 1]);
    };
    s.board_latency_p50_ms = percentile(50);
    s.board_latency_p99_ms = percentile(99);
  }
  if (restart) {
    link_latency_ms_.clear();
    interval_start_ = now;
    frames_ = 0;
    stage_ms_ = {};
    publish_ms_ = latency_ms_ = 0;
  }
  return s;
}

std::optional<StateReport> Health::refusal() const {
  const MutexLock lock(mutex_);
  return refusal_;
}

bool Health::has_subscribers() const {
  const MutexLock lock(mutex_);
  return has_subscribers_;
}

bool Health::has_published() const {
  const MutexLock lock(mutex_);
  return has_published_;
}

}  // namespace fpga_stereo
