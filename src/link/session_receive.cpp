// How a session handles what arrives: answers, polled counters, frames.
#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "link/register_values.hpp"
#include "link/session.hpp"

namespace fpga_stereo::link {
namespace {

struct PolledCounter {
  std::uint32_t BoardCounters::*counter;
  std::uint32_t address;
};
constexpr PolledCounter kBoardCounters[]{{&BoardCounters::frames_in, spec::kRegFramesIn},
                                         {&BoardCounters::frames_out, spec::kRegFramesOut},
                                         {&BoardCounters::cut_frames, spec::kRegCutFrames},
                                         {&BoardCounters::long_frames, spec::kRegLongFrames},
                                         {&BoardCounters::buffer_errors, spec::kRegBufferErrors},
                                         {&BoardCounters::frames_dropped, spec::kRegFramesDropped},
                                         {&BoardCounters::bad_packets, spec::kRegBadPackets},
                                         {&BoardCounters::lost_packets, spec::kRegLostPackets},
                                         {&BoardCounters::input_errors, spec::kRegInputErrors}};

}  // namespace

void Session::read_clocks(Time now, double wall) {
  now_ = now;
  const double step = host_.read(now, wall);
  if (step == 0) return;
  notes_.push_back(fmt::format("the system clock was set {} by {:.3f} s: stamps follow it",
                               step > 0 ? "forward" : "back", std::abs(step)));
}

void Session::receive(const std::uint8_t* bytes, std::size_t size, Time now, double wall) {
  read_clocks(now, wall);
  last_byte_ = now;
  decoder_.push(bytes, size);
  while (const auto packet = decoder_.next()) take(*packet);
  deliver();
}

void Session::take(const Packet& packet) {
  if (state_ == LinkState::kClosed) return;
  watchdog_.on_packet(now_);
  if (packet.header.version != kVersion) {
    return fail({ErrorKind::kIncompatible, version_text(packet.header.version)});
  }
  switch (packet.header.type) {
    case PacketType::kRegisters:
    case PacketType::kWritten:
    case PacketType::kRefused:
      return take_answer(packet);
    case PacketType::kLeader:
    case PacketType::kRows:
    case PacketType::kTrailer:
      // Until the board is configured, nobody knows what made a frame.
      if (configurator_->tags().empty() || packet.header.stream == Stream::kInput) return;
      watchdog_.on_frame_packet(now_);
      return receiver_.add(packet, configurator_->desired().streams);
    default:
      return;
  }
}

Status Session::check_clock(std::uint64_t board_time) {
  const std::uint64_t last = std::exchange(board_time_, board_time).value_or(board_time);
  // The clock may wrap: up to half of its range ahead is later.
  if (static_cast<std::int64_t>(board_time - last) >= 0) return {};
  return Error{ErrorKind::kIo, kBoardWasReset};
}

void Session::take_answer(const Packet& packet) {
  if (!requests_->is_answer(packet)) return;
  if (const Status status = check_clock(packet.header.timestamp); !status) {
    if (state_ == LinkState::kRefused) failures_ = 0;  // the reset may have cured the board
    return fail(status.error());
  }
  if (const auto sent = requests_->sent_at()) {
    receiver_.add_round_trip(*sent, packet.header.timestamp, now_);
  }
  const Status status = requests_->complete(packet, now_);
  if (!status) return fail(status.error());
  if (state_ == LinkState::kIdentifying && configurator_->is_identified()) {
    enter(LinkEvent::kIdentified);
  }
  if (const auto values = configurator_->take_polled()) {
    if (const Status polled = take_poll(*values); !polled) fail(polled.error());
  }
}

void Session::poll() {
  next_poll_ = now_ + options_.poll;
  if (state_ == LinkState::kRefused) {
    // An incompatible board may be flashed while its link stays open.
    if (refusal_.kind == ErrorKind::kIncompatible) {
      enter(LinkEvent::kRestarted);
      return configurator_->identify();
    }
    // Other refusals may pass: a frame that did not end, resets by a weak power supply.
    if (now_ >= next_retry_) {
      enter(LinkEvent::kRestarted);
      return restart();
    }
  }
  configurator_->poll();
}

Status Session::take_poll(const RequestQueue::Values& values) {
  const bool is_set_up = state_ == LinkState::kReady || state_ == LinkState::kStreaming;
  if (is_set_up && !configurator_->matches(values)) {
    if (configurator_->is_stale()) return {};
    return Error{ErrorKind::kIo, kBoardWasReset};
  }
  if (is_set_up) {
    BoardCounters now;
    now.errors = value_of(values, spec::kRegErrors);
    for (const auto& [counter, address] : kBoardCounters) now.*counter = value_of(values, address);
    count_up(now);
  }
  watchdog_.on_poll(board_.frames_in, state_ == LinkState::kStreaming);
  return {};
}

void Session::count_up(const BoardCounters& now) {
  const BoardCounters last = std::exchange(polled_, now).value_or(now);
  board_.errors = now.errors;
  for (const auto& [counter, address] : kBoardCounters) {
    const std::uint32_t added = now.*counter - last.*counter;
    const bool was_cleared = static_cast<std::int32_t>(added) < 0;
    board_.*counter += was_cleared ? 0 : added;
  }
}

Receiver::Context Session::context() const { return {configurator_->tags(), now_, host_}; }

void Session::deliver() {
  if (receiver_.deliver(context())) watchdog_.on_good_frames(now_);
}

void Session::flush() {
  if (receiver_.flush(context())) watchdog_.on_success();
}

}  // namespace fpga_stereo::link
