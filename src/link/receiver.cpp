#include "link/receiver.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace fpga_stereo::link {
namespace {

constexpr std::size_t kMaxHostPairs = 64;  // more than a board has in flight
// s: a stamp may be this much before and after the arrival of the frame's last byte. A serial line
// may need a minute for a frame.
constexpr double kMaxAge = 60, kMaxEarly = 0.1;

void drop(ReceivedFrames& frames, const std::string& why) {
  for (cv::Mat& image : frames.set.images) image.release();
  frames.set.dropped.insert(frames.set.dropped.begin(),
                            fmt::format("frame {} dropped: {}", frames.set.frame_id, why));
  frames.set.verdicts.insert(frames.set.verdicts.begin(), FrameVerdict::kBadStamp);
}

}  // namespace

void Receiver::add_round_trip(Time sent, std::uint64_t board_us, Time received) {
  const std::uint64_t steps = clock_.steps();
  if (clock_.add(seconds(sent), board_us, seconds(received))) has_noted_missing_clock_ = false;
  if (clock_.steps() != steps) {
    notes_.emplace_back("the board's clock has stepped: its time is converted anew");
  }
}

void Receiver::add_host_pair(std::uint64_t frame_id, std::uint64_t timestamp) {
  host_pairs_.emplace_back(frame_id, timestamp);
  if (host_pairs_.size() > kMaxHostPairs) host_pairs_.pop_front();
}

void Receiver::set_stamp(ReceivedFrames& frames, const Context& context) {
  const double now = seconds(context.now);
  frames.stamp = frames.arrived = context.host.wall(now);
  frames.clock_steps = context.host.steps();
  const PairKey key{frames.set.frame_id, frames.set.timestamp};
  if (std::find(host_pairs_.begin(), host_pairs_.end(), key) != host_pairs_.end()) {
    frames.stamp = static_cast<double>(frames.set.timestamp) * 1e-6;
    return;
  }
  if (!clock_.is_steady()) {
    return drop(frames, "the board's clock does not run at the rate of the host's");
  }
  const auto stamp = clock_.to_host(frames.set.timestamp);
  if (!stamp) {
    if (!std::exchange(has_noted_missing_clock_, true)) {
      notes_.emplace_back(
          "no round trip to the board takes less than 10 ms: frames are stamped with their time of "
          "arrival");
    }
    return;
  }
  const double age = now - *stamp;
  if (age < -kMaxEarly || age > kMaxAge) {
    return drop(frames,
                fmt::format("its time stamp is {:.1f} s {} its arrival; allowed are {} s "
                            "before and {} s after",
                            std::abs(age), age < 0 ? "after" : "before", kMaxAge, kMaxEarly));
  }
  frames.stamp = context.host.wall(*stamp);
}

bool Receiver::deliver(const Context& context) {
  bool has_image = false;
  for (FrameSet& set : complete_) {
    const auto tag = context.tags.find(set.configuration);
    if (!tag) {
      ++unknown_configurations_;
      notes_.push_back(fmt::format(
          "frame dropped: it was made by configuration {}, which this host did not send",
          set.configuration));
      continue;
    }
    ReceivedFrames frames;
    frames.set = std::move(set);
    frames.tag = *tag;
    set_stamp(frames, context);
    const auto& images = frames.set.images;
    has_image |= std::any_of(images.begin(), images.end(),
                             [](const cv::Mat& image) { return !image.empty(); });
    received_.push_back(std::move(frames));
  }
  complete_.clear();
  return has_image;
}

bool Receiver::flush(const Context& context) {
  builder_.end(complete_);
  return deliver(context);
}

void Receiver::forget_board() {
  host_pairs_.clear();
  clock_.reset();
}

}  // namespace fpga_stereo::link
