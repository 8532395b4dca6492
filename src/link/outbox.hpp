// Bytes that wait to be written to the transport.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "link/frame_assembler.hpp"
#include "link/packet.hpp"

namespace fpga_stereo::link {

/// Numbers the host's packets and counts the bytes that the transport has accepted.
class Outbox {
 public:
  /// Starts the counts for a new link. Sequence numbers continue.
  void clear() {
    bytes_.clear();
    queued_ = sent_ = 0;
  }
  void add_packet(Header header, const std::vector<std::uint8_t>& payload) {
    header.sequence = sequence_++;
    const std::size_t before = bytes_.size();
    append_packet(header, payload.data(), payload.size(), bytes_);
    queued_ += bytes_.size() - before;
  }
  /// Adds `image` as leader, rows and trailer; `frame` has stream, frame_id and timestamp.
  void add_frame(const Header& frame, const cv::Mat& image) {
    const std::size_t before = bytes_.size();
    append_frame(frame, image, 0, 0, kLinkMaxHostPayloadBytes, sequence_, bytes_);
    queued_ += bytes_.size() - before;
  }
  /// Records that the transport has accepted this many more bytes.
  void mark_sent(std::size_t bytes) { sent_ += bytes; }

  /// The bytes not taken yet. The caller takes them out.
  std::vector<std::uint8_t>& bytes() { return bytes_; }
  /// Bytes added since clear().
  std::uint64_t queued() const { return queued_; }
  /// Bytes accepted by the transport since clear().
  std::uint64_t sent() const { return sent_; }

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint64_t queued_ = 0, sent_ = 0;
  std::uint32_t sequence_ = kLinkFirstSequence;
};

}  // namespace fpga_stereo::link
