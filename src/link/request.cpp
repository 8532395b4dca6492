#include "link/request.hpp"

#include <fmt/core.h>

#include "core/signature.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::link {
namespace {

void append_word(std::uint32_t word, std::vector<std::uint8_t>& bytes) {
  bytes.resize(bytes.size() + 4);
  put_u32(&*(bytes.end() - 4), word);
}

}  // namespace

Request read_request(const std::vector<std::uint32_t>& addresses) {
  Request request{PacketType::kReadRegisters, {}};
  for (const std::uint32_t address : addresses) append_word(address, request.payload);
  return request;
}

Request write_request(const std::vector<RegisterWrite>& writes) {
  Request request{PacketType::kWriteRegisters, {}};
  for (const RegisterWrite& w : writes) {
    append_word(w.address, request.payload);
    append_word(w.value, request.payload);
  }
  return request;
}

Request mesh_request(bool right, const std::vector<std::uint32_t>& mesh, std::size_t first,
                     std::size_t count) {
  Request request{PacketType::kWriteMesh, {}};
  append_word(spec::kMeshAddressCamera.put(right ? 1 : 0) |
                  spec::kMeshAddressNode.put(static_cast<std::uint32_t>(first)),
              request.payload);
  for (std::size_t i = first; i < first + count; ++i) append_word(mesh[i], request.payload);
  return request;
}

std::uint32_t mesh_signature(const std::vector<std::uint32_t>& mesh, std::size_t first,
                             std::size_t count) {
  Signature signature;
  for (std::size_t i = first; i < first + count; ++i) signature.add(mesh[i]);
  return signature.value();
}

std::optional<std::vector<RegisterWrite>> unpack_registers(const Packet& packet) {
  if (packet.header.type != PacketType::kRegisters || packet.header.length % 8 != 0) {
    return std::nullopt;
  }
  std::vector<RegisterWrite> values;
  for (std::size_t at = 0; at < packet.header.length; at += 8) {
    values.push_back({get_u32(packet.payload + at), get_u32(packet.payload + at + 4)});
  }
  return values;
}

std::string refusal_text(const Packet& packet) {
  if (packet.header.length != 4) return "it gives no reason";
  switch (const std::uint32_t why = get_u32(packet.payload)) {
    case kRefusedVersion:
      return fmt::format("it does not know packets of version {}", kVersion);
    case kRefusedType:
      return "it does not know this type of request";
    case kRefusedLength:
      return "the length of the request is not allowed";
    default:
      return fmt::format("reason {}", why);
  }
}

}  // namespace fpga_stereo::link
