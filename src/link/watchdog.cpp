#include "link/watchdog.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::link {
namespace {

constexpr int kMaxDoublings = 6;  // of the time between steps while frames are missing

}  // namespace

void Watchdog::start(Time now) {
  last_packet_ = now;
  next_check_ = now + options_.silence;
}

void Watchdog::on_frame_packet(Time now) {
  last_frame_ = now;
  has_frame_since_poll_ = true;
}

void Watchdog::on_streams_changed(Time now, std::uint32_t frames_in, bool are_pairs_sent) {
  last_frame_ = now;
  are_pairs_sent_ = are_pairs_sent;
  due_since_.reset();
  if (!are_pairs_sent) due_since_ = now;
  has_frame_since_poll_ = true;
  frames_in_ = frames_in_at_frame_ = frames_in;
}

void Watchdog::on_pair_sent(Time now) {
  if (!due_since_) due_since_ = now;
}

void Watchdog::on_good_frames(Time now) {
  intervals_ = {intervals_[1], now - std::exchange(last_good_, now)};
  missing_steps_ = 0;
  due_since_.reset();
  if (!are_pairs_sent_) due_since_ = now;
  on_success();
}

void Watchdog::on_poll(std::uint32_t frames_in, bool is_streaming) {
  frames_in_ = frames_in;
  if (has_frame_since_poll_ || !is_streaming) frames_in_at_frame_ = frames_in;
  has_frame_since_poll_ = false;
  // While nothing is streamed, an answer is the only sign that the link works.
  if (!is_streaming) on_success();
}

void Watchdog::on_success() {
  trouble_ = {};
  next_step_ = WatchdogStep::kPurge;
}

bool Watchdog::is_stalled(Time now, int frame_interval) const {
  if (now - last_frame_ < options_.stall) return false;
  const auto allowed = static_cast<std::uint32_t>(options_.periods * frame_interval);
  return frames_in_ - frames_in_at_frame_ > allowed;
}

bool Watchdog::is_missing(Time now, int frame_interval) const {
  if (!due_since_) return false;
  // After an outage, one of the intervals contains it.
  const Clock::duration usual = options_.periods * std::min(intervals_[0], intervals_[1]);
  Clock::duration patience =
      std::max<Clock::duration>({options_.missing, std::chrono::seconds(frame_interval), usual});
  // Where no step helps, further ones come at ever longer intervals.
  patience *= 1 << std::min(missing_steps_, kMaxDoublings);
  if (now - last_frame_ < patience)
    patience = std::max<Clock::duration>(patience, options_.hopeless);
  return now - *due_since_ > patience;
}

std::optional<Trouble> Watchdog::check(Time now, bool is_streaming, int frame_interval) const {
  if (now < next_check_) return std::nullopt;
  if (now - last_packet_ > options_.silence) {
    return Trouble{LinkTrouble::kSilent, "the board sends nothing"};
  }
  if (is_streaming && is_stalled(now, frame_interval)) {
    return Trouble{LinkTrouble::kStalled, "the board takes images but sends no frames"};
  }
  if (is_streaming && is_missing(now, frame_interval)) {
    if (are_pairs_sent_ || frames_in_ != frames_in_at_frame_ || last_frame_ > *due_since_) {
      return Trouble{LinkTrouble::kStalled, "the board sends no good frames"};
    }
    return Trouble{LinkTrouble::kNoImages, "the board's cameras deliver no images"};
  }
  return std::nullopt;
}

void Watchdog::take(WatchdogStep step, const Trouble& trouble, Time now) {
  trouble_ = trouble;
  next_step_ =
      static_cast<WatchdogStep>(std::min(static_cast<int>(step) + 1, kNumWatchdogSteps - 1));
  ++steps_[static_cast<std::size_t>(step)];
  if (due_since_) ++missing_steps_;
  next_check_ = now + options_.step;
  last_packet_ = now;
}

}  // namespace fpga_stereo::link
