#include "link/decoder.hpp"

#include <algorithm>
#include <array>

namespace fpga_stereo::link {
namespace {

const std::array<std::uint8_t, 4> kSyncBytes = [] {
  std::array<std::uint8_t, 4> bytes{};
  put_u32(bytes.data(), kSync);
  return bytes;
}();

}  // namespace

void Decoder::push(const std::uint8_t* bytes, std::size_t size) {
  // Moves less than a packet if the caller has taken all packets.
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
  damaged_crc_.remove(at_);
  damaged_end_ -= std::min(damaged_end_, at_);
  at_ = 0;
  bytes_.insert(bytes_.end(), bytes, bytes + size);
  counters_.bytes += size;
}

void Decoder::skip(std::size_t bytes) {
  at_ += bytes;
  counters_.skipped_bytes += bytes;
}

bool Decoder::find_sync() {
  const auto begin = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
  auto found = std::search(begin, bytes_.end(), kSyncBytes.begin(), kSyncBytes.end());
  if (found == bytes_.end()) {
    // The last bytes may be the start of a sync word.
    const std::size_t max_part = std::min(left(), kSyncBytes.size() - 1);
    for (found = bytes_.end() - static_cast<std::ptrdiff_t>(max_part); found != bytes_.end();
         ++found) {
      if (std::equal(found, bytes_.end(), kSyncBytes.begin())) break;
    }
  }
  skip(static_cast<std::size_t>(found - begin));
  return left() >= kHeaderBytes;
}

void Decoder::count_lost(std::uint32_t sequence) {
  // A large gap is a step backwards: a repeated or late packet, or a board that was reset.
  const std::uint32_t gap = sequence - expected_.value_or(sequence);
  if (gap < 0x80000000U) counters_.lost_packets += gap;
  expected_ = sequence + 1;
}

bool Decoder::is_intact(const Header& header) {
  const std::uint8_t* packet = bytes_.data() + at_;
  const std::size_t begin = at_ + kLinkHeaderCrcAt, end = at_ + kHeaderBytes + header.length;
  const std::uint32_t crc = at_ < damaged_end_ ? damaged_crc_.of(bytes_.data(), begin, end)
                                               : payload_crc(packet, header.length);
  if (crc == get_u32(bytes_.data() + end)) return true;
  damaged_end_ = std::max(damaged_end_, end);
  return false;
}

std::optional<Packet> Decoder::next() {
  while (find_sync()) {
    const std::uint8_t* bytes = bytes_.data() + at_;
    const auto header = unpack(bytes);
    if (!header) {
      ++counters_.bad_headers;
      skip(1);
      continue;
    }
    const std::size_t size = kHeaderBytes + header->length + kCrcBytes;
    if (left() < size) return std::nullopt;
    if (!is_intact(*header)) {
      ++counters_.bad_payloads;
      skip(1);
      continue;
    }
    at_ += size;
    ++counters_.packets;
    count_lost(header->sequence);
    return Packet{*header, bytes + kHeaderBytes};
  }
  return std::nullopt;
}

void Decoder::discard_partial_packet() {
  if (find_sync()) ++counters_.bad_payloads;
  if (left() > 0) skip(1);
}

void Decoder::reset() {
  bytes_.clear();
  at_ = damaged_end_ = 0;
  damaged_crc_.clear();
  expected_.reset();
}

}  // namespace fpga_stereo::link
