#include "link/hostile_board.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::test {

void PacketEditor::operator()(Bytes& bytes) {
  decoder_.push(bytes.data(), bytes.size());
  bytes.clear();
  while (const auto packet = decoder_.next()) {
    link::Header header = packet->header;
    Bytes payload(packet->payload, packet->payload + header.length);
    if (edit_(header, payload)) link::append_packet(header, payload.data(), payload.size(), bytes);
  }
}

PacketEditor::Edit lying_clock(std::function<std::uint64_t(std::uint64_t)> clock) {
  return [clock = std::move(clock)](link::Header& header, Bytes&) {
    header.timestamp = clock(header.timestamp);
    return true;
  };
}

void HostileBoard::lie(PacketEditor::Edit edit) {
  const std::lock_guard lock(mutex_);
  editor_ = edit ? std::make_unique<PacketEditor>(std::move(edit)) : nullptr;
}

void HostileBoard::stop_reading(bool is_deaf) {
  const std::lock_guard lock(mutex_);
  is_deaf_ = is_deaf;
}

void HostileBoard::say(const Bytes& bytes) {
  const std::lock_guard lock(mutex_);
  out_.insert(out_.end(), bytes.begin(), bytes.end());
}

void HostileBoard::reset() {
  const std::lock_guard lock(mutex_);
  honest_->reset();
  out_.clear();
}

std::size_t HostileBoard::receive(const std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard lock(mutex_);
  return is_deaf_ ? 0 : honest_->receive(bytes, size);
}

std::size_t HostileBoard::transmit(std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (out_.empty()) {
    out_.resize(size);
    out_.resize(honest_->transmit(out_.data(), size));
    if (editor_) (*editor_)(out_);
  }
  const std::size_t taken = std::min(size, out_.size());
  std::copy_n(out_.begin(), taken, bytes);
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(taken));
  return taken;
}

void HostileBoard::feed(const sim::GreyPair& pair) {
  const std::lock_guard lock(mutex_);
  honest_->feed(pair);
}

void HostileBoard::run(std::chrono::microseconds time) {
  const std::lock_guard lock(mutex_);
  honest_->run(time);
}

}  // namespace fpga_stereo::test
