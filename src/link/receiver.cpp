#include "link/receiver.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace fpga_stereo::link {
namespace {

constexpr std::size_t kMaxHostPairs = 64;  // more than a board has in flight

}  // namespace

void Receiver::add(const Packet& packet) {
  assembler_.add(packet, assembled_);
  const Header& header = packet.header;
  if (header.type == PacketType::kLeader &&
      assembler_.frame_in_flight(header.stream) == header.frame_id) {
    collector_.begin(header.stream, header.frame_id);
  }
}

void Receiver::add_round_trip(double sent, std::uint64_t board_us, double received) {
  if (clock_.add(sent, board_us, received)) has_noted_missing_clock_ = false;
}

void Receiver::add_host_pair(std::uint64_t frame_id, std::uint64_t timestamp) {
  host_pairs_.emplace_back(frame_id, timestamp);
  if (host_pairs_.size() > kMaxHostPairs) host_pairs_.pop_front();
}

void Receiver::set_stamp(ReceivedFrames& frames) {
  const PairKey key{frames.set.frame_id, frames.set.timestamp};
  if (std::find(host_pairs_.begin(), host_pairs_.end(), key) != host_pairs_.end()) {
    frames.stamp = static_cast<double>(frames.set.timestamp) * 1e-6;
  } else if (const auto stamp = clock_.to_host(frames.set.timestamp)) {
    frames.stamp = *stamp;
  } else if (!has_noted_missing_clock_) {
    has_noted_missing_clock_ = true;
    notes_.emplace_back(
        "no round trip to the board takes less than 10 ms: frames are stamped with their time of "
        "arrival");
  }
}

bool Receiver::deliver(const Context& context) {
  bool has_image = false;
  for (AssembledFrame& frame : assembled_) {
    collector_.add(std::move(frame), context.expected, complete_);
  }
  assembled_.clear();
  for (FrameSet& set : complete_) {
    const auto tag = context.tags.find(set.configuration);
    if (!tag) {
      ++unknown_configurations_;
      notes_.push_back(fmt::format(
          "frame dropped: it was made by configuration {}, which this host did not send",
          set.configuration));
      continue;
    }
    ReceivedFrames frames{std::move(set), *tag, context.host, context.host};
    set_stamp(frames);
    const auto& images = frames.set.images;
    has_image |= std::any_of(images.begin(), images.end(),
                             [](const cv::Mat& image) { return !image.empty(); });
    received_.push_back(std::move(frames));
  }
  complete_.clear();
  return has_image;
}

bool Receiver::flush(const Context& context) {
  assembler_.reset(assembled_);
  const bool has_image = deliver(context);
  collector_.reset(complete_);
  return deliver(context) || has_image;
}

void Receiver::forget_board() {
  host_pairs_.clear();
  clock_.reset();
}

}  // namespace fpga_stereo::link
