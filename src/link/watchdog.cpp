#include "link/watchdog.hpp"

#include <algorithm>

namespace fpga_stereo::link {

void Watchdog::start(Time now) {
  last_packet_ = now;
  next_check_ = now + options_.silence;
}

void Watchdog::on_frame_packet(Time now) {
  last_frame_ = now;
  has_frame_since_poll_ = true;
}

void Watchdog::on_streams_changed(Time now, std::uint32_t frames_in) {
  last_frame_ = now;
  has_frame_since_poll_ = true;
  frames_in_at_frame_ = frames_in;
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

std::optional<Trouble> Watchdog::check(Time now, bool is_streaming, int frame_interval) const {
  if (now < next_check_) return std::nullopt;
  if (now - last_packet_ > options_.silence) {
    return Trouble{LinkTrouble::kSilent, "the board sends nothing"};
  }
  if (is_streaming && is_stalled(now, frame_interval)) {
    return Trouble{LinkTrouble::kStalled, "the board takes images but sends no frames"};
  }
  return std::nullopt;
}

void Watchdog::take(WatchdogStep step, const Trouble& trouble, Time now) {
  trouble_ = trouble;
  next_step_ =
      static_cast<WatchdogStep>(std::min(static_cast<int>(step) + 1, kNumWatchdogSteps - 1));
  ++steps_[static_cast<std::size_t>(step)];
  next_check_ = now + options_.step;
  last_packet_ = now;
}

}  // namespace fpga_stereo::link
