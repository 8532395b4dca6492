// What the host asks of a board, and what the board answers: fpga_fw/spec/link.md.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "link/decoder.hpp"

namespace fpga_stereo::link {

constexpr std::size_t kMaxReads = kLinkMaxRequestRegisters;
constexpr std::size_t kMaxWrites = kLinkMaxRequestRegisters;
constexpr std::size_t kMaxNodes = kLinkMaxRequestNodes;

/// A request without what the session adds: id and sequence number.
struct Request {
  PacketType type = PacketType::kReadRegisters;
  std::vector<std::uint8_t> payload;
};

/// Reads registers at these word addresses: 1 to kMaxReads.
Request read_request(const std::vector<std::uint32_t>& addresses);
/// Writes registers in this order: 1 to kMaxWrites.
Request write_request(const std::vector<RegisterWrite>& writes);
/// Writes nodes [first, first + count) of a mesh, whose words are `mesh`: 1 to kMaxNodes of them.
Request mesh_request(bool right, const std::vector<std::uint32_t>& mesh, std::size_t first,
                     std::size_t count);

/// What MESH_SIGNATURE shows behind that request.
std::uint32_t mesh_signature(const std::vector<std::uint32_t>& mesh, std::size_t first,
                             std::size_t count);

/// Address and value, from PacketType::kRegisters; none if it is no such answer.
std::optional<std::vector<RegisterWrite>> unpack_registers(const Packet& packet);
/// Why the board refused, from PacketType::kRefused, for people.
std::string refusal_text(const Packet& packet);

}  // namespace fpga_stereo::link
