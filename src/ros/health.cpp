#include "ros/health.hpp"

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
  const std::lock_guard<std::mutex> lock(mutex_);
  ++in_;
}

void Health::dropped(DropCause cause, std::uint64_t frames) {
  const std::lock_guard<std::mutex> lock(mutex_);
  dropped_[static_cast<std::size_t>(cause)] += frames;
}

void Health::refused(DropCause cause, const std::string& why) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++dropped_[static_cast<std::size_t>(cause)];
  refusal_ = why;
}

void Health::published(const StageTimes& stages, double publish_ms, double latency_ms) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++published_;
  ++frames_;
  refusal_.clear();
  for (std::size_t i = 0; i < stages.size(); ++i) stage_ms_[i] += stages[i];
  publish_ms_ += publish_ms;
  latency_ms_ += latency_ms;
}

void Health::link_latency(double ms) {
  const std::lock_guard<std::mutex> lock(mutex_);
  constexpr std::size_t kMost = 10000;
  if (link_latency_ms_.size() < kMost) link_latency_ms_.push_back(ms);
}

void Health::listening(bool anyone) {
  const std::lock_guard<std::mutex> lock(mutex_);
  listening_ = anyone;
}

StereoStatus Health::report(bool restart) {
  const std::lock_guard<std::mutex> lock(mutex_);
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
    const auto stage = [&](Stage which) {
      return mean(stage_ms_[static_cast<std::size_t>(which)]);
    };
    s.rate = static_cast<float>(n / std::max((now - since_).toSec(), 1e-3));
    s.latency_ms = mean(latency_ms_);
    s.rectify_ms = stage(Stage::kRectify);
    s.census_ms = stage(Stage::kCensus);
    s.match_ms = stage(Stage::kMatch);
    s.select_ms = stage(Stage::kSelect);
    s.check_ms = stage(Stage::kCheck);
    s.subpixel_ms = stage(Stage::kSubpixel);
    s.speckle_ms = stage(Stage::kSpeckle);
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
    since_ = now;
    frames_ = 0;
    stage_ms_ = {};
    publish_ms_ = latency_ms_ = 0;
  }
  return s;
}

std::uint64_t Health::published_count() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return published_;
}

std::string Health::refusal() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return refusal_;
}

bool Health::anyone_listens() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return listening_;
}

}  // namespace fpga_stereo
