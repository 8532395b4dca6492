// BoardSource: what arrives from the board.
#include <fmt/format.h>

#include <utility>

#include "ros/board_source.hpp"

namespace fpga_stereo {

using link::FrameSet;
using link::Stream;

void BoardSource::on_received(const Received& received) {
  if (settings_.topic_input) {
    receive_host_pair(received);
  } else {
    receive_camera_pair(received);
  }
}

BoardSource::Context BoardSource::context_of(const Received& received) const {
  Context context;
  context.planned = plan_.configuration(received.tag);
  context.settings = node_settings_;
  context.demand = demand_;
  context.is_unwanted = plan_.desired_state().streams.empty();
  context.is_incomplete = !settings_.topic_input && plan_.is_incomplete(received.set);
  return context;
}

Status BoardSource::check(const Received& received, const Context& context) const {
  if (!context.planned) {
    return Error{ErrorKind::kIo, "board frame dropped: its configuration is too old"};
  }
  if (context.is_incomplete) return Error{ErrorKind::kIo, received.set.dropped.front()};
  return check_sizes(received.set, context.planned->image_size);
}

void BoardSource::count_lost(const FrameSet& set) {
  constexpr std::uint64_t kMaxGap = 1000;  // more: the board has begun to count anew
  if (last_frame_) {
    const auto step = static_cast<std::uint64_t>(settings_.frame_interval);
    const std::uint64_t gap = (set.frame_id - *last_frame_) / step;
    for (std::uint64_t i = 1; i < gap && gap < kMaxGap; ++i) {
      health_.received();
      health_.dropped(DropCause::kLink);
    }
  }
  last_frame_ = set.frame_id;
}

void BoardSource::verify(const FrameSet& set, const Planned& planned, const SourcePair& pair) {
  if (!planned.rectification || !set.verdicts.empty()) return;
  if (pair.raw.left.empty() || pair.raw.right.empty()) return;
  if (set.image(Stream::kDisparity).empty()) return;
  verifier_.offer(set.frame_id,
                  {pair, set.image(Stream::kDisparity), planned.rectification, planned.parameters});
}

void BoardSource::receive_host_pair(const Received& received) {
  Context context;
  std::optional<PairsInFlight::Returned> returned;
  {
    const MutexLock lock(mutex_);
    returned = in_flight_.take(received.set.frame_id, Clock::now());
    if (!returned) return;  // given up, and counted as lost
    context = context_of(received);
  }
  health_.dropped(DropCause::kLink, returned->lost);
  if (const Status usable = check(received, context); !usable) {
    return health_.refused(DropCause::kLink, usable.error().message);
  }
  const SourcePair& pair = returned->pair;
  if (received.set.timestamp != static_cast<std::uint64_t>(pair.raw.stamp_ns / 1000)) {
    return health_.refused(
        DropCause::kLink,
        fmt::format("board frame dropped: pair {} has another time stamp than the host's",
                    received.set.frame_id));
  }
  const auto frame =
      frame_of_host_pair(received, *context.planned, pair, context.settings, context.demand);
  if (!frame) return health_.refused(DropCause::kLink, frame.error().message);
  verify(received.set, *context.planned, pair);
  callbacks_.frame(*frame);
}

void BoardSource::receive_camera_pair(const Received& received) {
  Context context;
  {
    const MutexLock lock(mutex_);
    context = context_of(received);
    if (context.is_unwanted) return;
    count_lost(received.set);
  }
  health_.received();
  if (const Status usable = check(received, context); !usable) {
    return health_.refused(DropCause::kLink, usable.error().message);
  }
  const auto stamp = to_stamp(received.stamp);
  if (!stamp) return health_.refused(DropCause::kStamp, stamp.error().message);
  if (std::exchange(clock_steps_, received.clock_steps) != received.clock_steps) {
    gate_.restart("the system clock was set");
  }
  const Result<std::uint64_t> number = gate_.accept(*stamp);
  if (!number) {
    return health_.refused(DropCause::kStamp, "board frame dropped: " + number.error().message);
  }
  const SourcePair pair =
      camera_pair(received.set, *context.planned, *stamp, settings_.frame_id, *number);
  cameras_.publish(pair.raw);
  callbacks_.images(pair);
  if (context.demand.needs_pairs() && !context.planned->rectification) {
    if (const Status raw = check_raw_images(received.set); !raw) {
      return health_.refused(DropCause::kLink, raw.error().message);
    }
    return callbacks_.pair(pair);
  }
  verify(received.set, *context.planned, pair);
  callbacks_.frame(
      frame_of_camera_pair(received, *context.planned, pair, context.settings, context.demand));
}

}  // namespace fpga_stereo
