// A board that speaks the protocol correctly until it is told otherwise, for tests of what a
// hostile device can do.
#pragma once

#include <functional>
#include <memory>
#include <mutex>

#include "link/decoder.hpp"
#include "link/faults.hpp"
#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::test {

/// Changes packets on their way; their CRCs are made right again.
class PacketEditor {
 public:
  /// Changes one packet. Returns false to lose it.
  using Edit = std::function<bool(link::Header& header, Bytes& payload)>;

  explicit PacketEditor(Edit edit) : edit_(std::move(edit)) {}
  /// Replaces bytes by the edited packets that they complete.
  void operator()(Bytes& bytes);

 private:
  Edit edit_;
  link::Decoder decoder_;
};

/// Returns an edit that shows the board's clock as `clock` of what it is, both in us.
PacketEditor::Edit lying_clock(std::function<std::uint64_t(std::uint64_t)> clock);

/// Thread-safe.
class HostileBoard : public sim::Board {
 public:
  explicit HostileBoard(std::unique_ptr<sim::Board> honest) : honest_(std::move(honest)) {}

  /// Edits what it sends from now on; null: is honest.
  void lie(PacketEditor::Edit edit);
  /// Takes no more bytes from the host, or does again.
  void stop_reading(bool is_deaf);
  /// Sends these bytes next.
  void say(const Bytes& bytes);

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  void feed(const sim::GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

 private:
  std::mutex mutex_;
  const std::unique_ptr<sim::Board> honest_;
  std::unique_ptr<PacketEditor> editor_;
  bool is_deaf_ = false;
  Bytes out_;
};

}  // namespace fpga_stereo::test
