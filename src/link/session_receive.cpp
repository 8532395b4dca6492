// What a session makes of the bytes that come.
#include <algorithm>
#include <string>
#include <utility>

#include "link/session.hpp"

namespace fpga_stereo::link {

void Session::receive(const std::uint8_t* bytes, std::size_t size, Time now, double host) {
  now_ = last_byte_ = now;
  host_ = host;
  decoder_.push(bytes, size);
  while (const auto packet = decoder_.next()) take(*packet);
  deliver();
}

void Session::take(const Packet& packet) {
  if (state_ == LinkState::kClosed) return;
  last_packet_ = now_;
  if (packet.header.version != kVersion) {
    failed({ErrorKind::kIncompatible, version_text(packet.header.version)});
    return;
  }
  switch (packet.header.type) {
    case PacketType::kRegisters:
    case PacketType::kWritten:
    case PacketType::kRefused:
      return take_answer(packet);
    case PacketType::kLeader:
    case PacketType::kRows:
    case PacketType::kTrailer:
      // Before the board is configured nothing is known about what made a frame.
      if (tags_.empty() || packet.header.stream == Stream::kInput) return;
      last_frame_ = now_;
      frame_came_ = true;
      assembler_.add(packet, assembled_);
      if (packet.header.type == PacketType::kLeader &&
          assembler_.frame_in_flight(packet.header.stream) == packet.header.frame_id) {
        sets_.begin(packet.header.stream, packet.header.frame_id);
      }
      return;
    default:
      return;
  }
}

Status Session::check_clock(std::uint64_t board_time) {
  const std::uint64_t before = board_time_.value_or(board_time);
  board_time_ = board_time;
  // The clock wraps; what is less than half of that ahead is later.
  if (static_cast<std::int64_t>(board_time - before) >= 0) return {};
  return Error{ErrorKind::kIo, kWasReset};
}

void Session::take_answer(const Packet& packet) {
  if (!in_flight_ || packet.header.index != in_flight_->id) return;  // a late one
  if (const Status same = check_clock(packet.header.timestamp); !same) {
    if (state_ == LinkState::kRefused) attempts_ = 0;  // it may have been seen to
    return failed(same.error());
  }
  if (clock_.add(in_flight_->sent, packet.header.timestamp, host_)) unstamped_ = false;
  const Job job = std::move(jobs_.front());
  const bool read = job.request.type == PacketType::kReadRegisters;
  Result<std::vector<RegisterWrite>> result{std::vector<RegisterWrite>{}};
  if (packet.header.type == PacketType::kRefused) {
    result = Error{ErrorKind::kIo, "the board refuses a request: " + refusal_text(packet)};
  } else if (read) {
    const auto values = unpack_registers(packet);
    bool expected = values && values->size() * 4 == job.request.payload.size();
    for (std::size_t i = 0; expected && i < values->size(); ++i) {
      expected = (*values)[i].address == get_u32(&job.request.payload[4 * i]);
    }
    if (!expected) {  // it is sent again in time
      jobs_.front() = job;
      return;
    }
    result = *values;
  } else if (packet.header.type != PacketType::kWritten) {
    jobs_.front() = job;
    return;
  }
  in_flight_.reset();
  jobs_.pop_front();
  if (job.answer) {
    job.answer(std::move(result));
  } else if (!result) {
    failed(result.error());
  } else if (const Status status = job.done(*result); !status) {
    failed(status.error());
  }
}

bool Session::is_hosts(const FrameSet& set) const {
  return std::find(pairs_.begin(), pairs_.end(), PairKey{set.frame_id, set.timestamp}) !=
         pairs_.end();
}

void Session::deliver() {
  for (AssembledFrame& frame : assembled_) {
    sets_.add(std::move(frame), desired_.streams, complete_);
  }
  assembled_.clear();
  for (FrameSet& set : complete_) {
    const auto after = tags_.upper_bound(set.configuration);
    if (after == tags_.begin()) {
      ++counters_.unknown_configurations;
      notes_.push_back("frame dropped: it was made by configuration " +
                       std::to_string(set.configuration) + ", which is not ours");
      continue;
    }
    ReceivedFrames received{std::move(set), std::prev(after)->second, host_, host_};
    if (is_hosts(received.set)) {
      received.stamp = static_cast<double>(received.set.timestamp) * 1e-6;
    } else if (const auto stamp = clock_.to_host(received.set.timestamp)) {
      received.stamp = *stamp;
    } else if (!unstamped_) {
      unstamped_ = true;
      notes_.push_back(
          "no round trip to the board takes less than 10 ms: stamps are times of "
          "arrival");
    }
    const auto& images = received.set.images;
    if (std::any_of(images.begin(), images.end(), [](const cv::Mat& i) { return !i.empty(); })) {
      watchdog_trouble_ = LinkTrouble::kNone;
      ladder_ = 0;
    }
    received_.push_back(std::move(received));
  }
  complete_.clear();
}

}  // namespace fpga_stereo::link
