// How a session handles what arrives: answers, polled counters, frames.
#include <utility>

#include "link/register_values.hpp"
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
      return receiver_.add(packet);
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
  receiver_.add_round_trip(requests_->sent_at(), packet.header.timestamp, host_);
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
  board_.errors = value_of(values, spec::kRegErrors);
  board_.frames_in = value_of(values, spec::kRegFramesIn);
  board_.frames_out = value_of(values, spec::kRegFramesOut);
  board_.cut_frames = value_of(values, spec::kRegCutFrames);
  board_.long_frames = value_of(values, spec::kRegLongFrames);
  board_.buffer_errors = value_of(values, spec::kRegBufferErrors);
  board_.frames_dropped = value_of(values, spec::kRegFramesDropped);
  board_.bad_packets = value_of(values, spec::kRegBadPackets);
  board_.lost_packets = value_of(values, spec::kRegLostPackets);
  board_.input_errors = value_of(values, spec::kRegInputErrors);
  watchdog_.on_poll(board_.frames_in, state_ == LinkState::kStreaming);
  return {};
}

Receiver::Context Session::context() const {
  return {configurator_->desired().streams, configurator_->tags(), host_};
}

void Session::deliver() {
  if (receiver_.deliver(context())) watchdog_.on_success();
}

void Session::flush() {
  if (receiver_.flush(context())) watchdog_.on_success();
}

}  // namespace fpga_stereo::link
