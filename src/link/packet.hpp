// Packs and unpacks the packets of the link. fpga_fw/spec/link.md describes the protocol.
//
// A packet is a header of 36 bytes, a payload, and the payload's CRC. Numbers are little-endian.
// The places of sync, version, length and both CRCs never change, so that a packet of another
// version is recognised as such.
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

/// The header of a packet:
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
/// The payload is followed by a u32, the CRC-32C of the header's CRC and the payload. This binds a
/// payload to its header: a header, which ends with its own CRC, never passes for the payload of
/// another packet.
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

/// Returns the CRC-32C (Castagnoli): polynomial 0x1EDC6F41, reflected, starts as all ones, inverted
/// at the end.
std::uint32_t crc32c(const std::uint8_t* bytes, std::size_t size);

/// Read and write little-endian numbers.
std::uint16_t get_u16(const std::uint8_t* bytes);
std::uint32_t get_u32(const std::uint8_t* bytes);
std::uint64_t get_u64(const std::uint8_t* bytes);
void put_u16(std::uint8_t* bytes, std::uint16_t value);
void put_u32(std::uint8_t* bytes, std::uint32_t value);
void put_u64(std::uint8_t* bytes, std::uint64_t value);

std::array<std::uint8_t, kHeaderBytes> pack(const Header& header);

/// Returns the payload CRC of a packet that begins at `packet` and has `length` bytes of payload.
std::uint32_t payload_crc(const std::uint8_t* packet, std::size_t length);

/// Unpacks a header from kHeaderBytes bytes. Returns nullopt if sync or CRC are wrong, or the
/// length is not allowed. Type, stream and version may be unknown.
std::optional<Header> unpack(const std::uint8_t* bytes);

/// Appends a packet to `stream`. Sets the header's length from the payload, which is padded with
/// zeros to a multiple of 4 bytes. Throws std::invalid_argument if it exceeds kMaxPayloadBytes.
void append_packet(Header header, const std::uint8_t* payload, std::size_t size,
                   std::vector<std::uint8_t>& stream);

}  // namespace fpga_stereo::link
