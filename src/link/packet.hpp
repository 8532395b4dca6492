// The packets of the link, as bytes. fpga_fw/spec/link.md is the protocol for people.
//
// Everything goes over the link in packets: a header of 36 bytes, a payload, its CRC. Numbers are
// little-endian. The places of sync, version, length and both CRCs never change, so that a version
// that is not ours can still be told.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "fpga_stereo/core/spec.hpp"
#include "fpga_stereo/link/streams.hpp"

namespace fpga_stereo::link {

constexpr std::uint32_t kSync = kLinkSync;
constexpr std::uint8_t kVersion = kLinkVersion;
constexpr std::size_t kHeaderBytes = kLinkHeaderBytes;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kMaxPayloadBytes = kLinkMaxPayloadBytes;
constexpr std::size_t kMaxPacketBytes = kHeaderBytes + kMaxPayloadBytes + kCrcBytes;

enum class PacketType : std::uint8_t {
  // Host to board.
  kReadRegisters = kPacketReadRegisters,
  kWriteRegisters = kPacketWriteRegisters,
  kWriteMesh = kPacketWriteMesh,
  // Both ways.
  kLeader = kPacketLeader,
  kRows = kPacketRows,
  kTrailer = kPacketTrailer,
  // Board to host.
  kRegisters = kPacketRegisters,
  kWritten = kPacketWritten,
  kRefused = kPacketRefused,
  kHeartbeat = kPacketHeartbeat,
};

/// What precedes the payload:
///
///   offset  type  field
///    0      u32   kSync
///    4      u8    version
///    5      u8    type
///    6      u8    flags      0 in this version
///    7      u8    stream
///    8      u16   length     bytes of payload, a multiple of 4, at most kMaxPayloadBytes
///   10      u16   index      rows: number of the first; requests and answers: request id
///   12      u32   sequence   of all packets of a direction: 1 more each, modulo 2^32
///   16      u64   frame_id   leader, rows, trailer: 1 more with each frame pair
///   24      u64   timestamp  us of the board's clock; leader: mid-exposure, else: sent
///   32      u32   CRC-32C of the 32 bytes before
///
/// Behind the payload: u32, CRC-32C of the header's CRC and the payload. So a payload is that of
/// its header alone; a header, which ends with its own CRC, is never taken for the payload of
/// another.
struct Header {
  std::uint8_t version = kVersion;
  PacketType type = PacketType::kHeartbeat;
  std::uint8_t flags = 0;
  Stream stream = Stream::kNone;
  std::uint16_t length = 0;
  std::uint16_t index = 0;
  std::uint32_t sequence = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t timestamp = 0;
};

/// CRC-32C (Castagnoli): polynomial 0x1EDC6F41, reflected, starts as all ones, inverted at the end.
std::uint32_t crc32c(const std::uint8_t* bytes, std::size_t size);

/// Little-endian numbers in bytes.
std::uint16_t get_u16(const std::uint8_t* bytes);
std::uint32_t get_u32(const std::uint8_t* bytes);
std::uint64_t get_u64(const std::uint8_t* bytes);
void put_u16(std::uint8_t* bytes, std::uint16_t value);
void put_u32(std::uint8_t* bytes, std::uint32_t value);
void put_u64(std::uint8_t* bytes, std::uint64_t value);

std::array<std::uint8_t, kHeaderBytes> pack(const Header& header);

/// The CRC behind the payload of a packet that begins at `packet` and has `length` bytes of
/// payload.
std::uint32_t payload_crc(const std::uint8_t* packet, std::size_t length);

/// The header in kHeaderBytes bytes; none if sync or CRC are wrong, or length is not allowed. Type,
/// stream and version may be ones that are not known.
std::optional<Header> unpack(const std::uint8_t* bytes);

/// Appends a whole packet to `stream`. `header.length` is set from `payload`, which is filled up
/// with zeros to a multiple of 4. Throws std::invalid_argument beyond kMaxPayloadBytes.
void append_packet(Header header, const std::uint8_t* payload, std::size_t size,
                   std::vector<std::uint8_t>& stream);

}  // namespace fpga_stereo::link
