// Packs requests to a board and unpacks its answers. fpga_fw/spec/link.md describes them.
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

/// A request. RequestQueue adds its id, Outbox its sequence number.
struct Request {
  PacketType type = PacketType::kReadRegisters;
  std::vector<std::uint8_t> payload;
};

/// Makes a request that reads registers at these word addresses: 1 to kMaxReads.
Request read_request(const std::vector<std::uint32_t>& addresses);
/// Makes a request that writes registers in this order: 1 to kMaxWrites.
Request write_request(const std::vector<RegisterWrite>& writes);
/// Makes a request that writes nodes [first, first + count) of a mesh: 1 to kMaxNodes. `mesh` holds
/// the words of all nodes.
Request mesh_request(bool right, const std::vector<std::uint32_t>& mesh, std::size_t first,
                     std::size_t count);

/// Returns what register MESH_SIGNATURE holds after that request.
std::uint32_t mesh_signature(const std::vector<std::uint32_t>& mesh, std::size_t first,
                             std::size_t count);

/// Unpacks addresses and values from a PacketType::kRegisters packet; nullopt if it is not one.
std::optional<std::vector<RegisterWrite>> unpack_registers(const Packet& packet);
/// Returns a text for people about a PacketType::kRefused packet.
std::string refusal_text(const Packet& packet);

}  // namespace fpga_stereo::link
