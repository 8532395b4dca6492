#include "link/packet.hpp"

#include <fmt/core.h>

#include <boost/crc.hpp>
#include <stdexcept>

namespace fpga_stereo::link {
namespace {

/// Reads a number from little-endian bytes.
template <class Number>
Number get(const std::uint8_t* bytes) {
  Number value = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    value = static_cast<Number>(value | static_cast<Number>(bytes[i]) << (8 * i));
  }
  return value;
}

template <class Number>
void put(std::uint8_t* bytes, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
}

}  // namespace

std::uint32_t crc32c(const std::uint8_t* bytes, std::size_t size) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes, size);
  return crc.checksum();
}

std::uint16_t get_u16(const std::uint8_t* bytes) { return get<std::uint16_t>(bytes); }
std::uint32_t get_u32(const std::uint8_t* bytes) { return get<std::uint32_t>(bytes); }
std::uint64_t get_u64(const std::uint8_t* bytes) { return get<std::uint64_t>(bytes); }
void put_u16(std::uint8_t* bytes, std::uint16_t value) { put(bytes, value); }
void put_u32(std::uint8_t* bytes, std::uint32_t value) { put(bytes, value); }
void put_u64(std::uint8_t* bytes, std::uint64_t value) { put(bytes, value); }

std::array<std::uint8_t, kHeaderBytes> pack(const Header& header) {
  std::array<std::uint8_t, kHeaderBytes> bytes{};
  put_u32(&bytes[kLinkHeaderSyncAt], kSync);
  bytes[kLinkHeaderVersionAt] = header.version;
  bytes[kLinkHeaderTypeAt] = static_cast<std::uint8_t>(header.type);
  bytes[kLinkHeaderFlagsAt] = header.flags;
  bytes[kLinkHeaderStreamAt] = static_cast<std::uint8_t>(header.stream);
  put_u16(&bytes[kLinkHeaderLengthAt], header.length);
  put_u16(&bytes[kLinkHeaderIndexAt], header.index);
  put_u32(&bytes[kLinkHeaderSequenceAt], header.sequence);
  put_u64(&bytes[kLinkHeaderFrameIdAt], header.frame_id);
  put_u64(&bytes[kLinkHeaderTimestampAt], header.timestamp);
  put_u32(&bytes[kLinkHeaderCrcAt], crc32c(bytes.data(), kHeaderBytes - kCrcBytes));
  return bytes;
}

std::uint32_t payload_crc(const std::uint8_t* packet, std::size_t length) {
  return crc32c(packet + kLinkHeaderCrcAt, kCrcBytes + length);
}

std::optional<Header> unpack(const std::uint8_t* bytes) {
  if (get_u32(bytes + kLinkHeaderSyncAt) != kSync) return std::nullopt;
  // Before the CRC, which takes long: so sync words that follow each other cost little.
  const std::uint16_t length = get_u16(bytes + kLinkHeaderLengthAt);
  if (length > kMaxPayloadBytes || length % 4 != 0) return std::nullopt;
  if (get_u32(bytes + kLinkHeaderCrcAt) != crc32c(bytes, kHeaderBytes - kCrcBytes)) {
    return std::nullopt;
  }
  Header header;
  header.version = bytes[kLinkHeaderVersionAt];
  header.type = static_cast<PacketType>(bytes[kLinkHeaderTypeAt]);
  header.flags = bytes[kLinkHeaderFlagsAt];
  header.stream = static_cast<Stream>(bytes[kLinkHeaderStreamAt]);
  header.length = length;
  header.index = get_u16(bytes + kLinkHeaderIndexAt);
  header.sequence = get_u32(bytes + kLinkHeaderSequenceAt);
  header.frame_id = get_u64(bytes + kLinkHeaderFrameIdAt);
  header.timestamp = get_u64(bytes + kLinkHeaderTimestampAt);
  return header;
}

void append_packet(Header header, const std::uint8_t* payload, std::size_t size,
                   std::vector<std::uint8_t>& stream) {
  const std::size_t length = (size + 3) / 4 * 4;
  if (length > kMaxPayloadBytes) {
    throw std::invalid_argument(
        fmt::format("payload has {} bytes; allowed are up to {}", size, kMaxPayloadBytes));
  }
  header.length = static_cast<std::uint16_t>(length);
  const std::size_t begin = stream.size();
  const auto bytes = pack(header);
  stream.insert(stream.end(), bytes.begin(), bytes.end());
  stream.insert(stream.end(), payload, payload + size);
  stream.resize(begin + kHeaderBytes + length + kCrcBytes, 0);
  put_u32(&stream[begin + kHeaderBytes + length], payload_crc(&stream[begin], length));
}

}  // namespace fpga_stereo::link
