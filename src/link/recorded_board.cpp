#include "link/recorded_board.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "fpga_stereo/core/spec.hpp"
#include "link/request.hpp"

namespace fpga_stereo::link {
namespace {

constexpr std::size_t kKeptRequests = 64;        // no late answer belongs to an older one
constexpr std::size_t kKeptConfigurations = 16;  // no late frame belongs to an older one

std::vector<std::uint32_t> words_of(const Packet& packet) {
  std::vector<std::uint32_t> words;
  for (std::size_t at = 0; at + 4 <= packet.header.length; at += 4) {
    words.push_back(get_u32(packet.payload + at));
  }
  return words;
}

bool is_configuration_register(std::uint32_t address) {
  return address >= spec::kConfigurationBegin && address < spec::kConfigurationEnd;
}

}  // namespace

Parameters RecordedConfiguration::parameters() const {
  Parameters parameters = parameters_of(configuration.build);
  for (const RegisterWrite& each : configuration.registers) {
    set_parameters(parameters, each.address, each.value);
  }
  return parameters;
}

bool RecordedConfiguration::equals(const GatewareConfiguration& other) const {
  if (!(configuration.build == other.build) || configuration.mesh != other.mesh) return false;
  std::map<std::uint32_t, std::uint32_t> held;
  for (const RegisterWrite& each : configuration.registers) held[each.address] = each.value;
  return std::all_of(other.registers.begin(), other.registers.end(),
                     [&](const RegisterWrite& each) {
                       const auto found = held.find(each.address);
                       return found != held.end() && found->second == each.value;
                     });
}

void RecordedBoard::add_from_host(const Packet& packet) {
  if (packet.header.stream != Stream::kNone) return;  // a pair
  requests_.push_back(packet.header.index);
  if (requests_.size() > kKeptRequests) requests_.pop_front();
  const std::vector<std::uint32_t> words = words_of(packet);
  if (packet.header.type == PacketType::kWriteRegisters) {
    for (std::size_t i = 0; i + 1 < words.size(); i += 2) write(words[i], words[i + 1]);
  } else if (packet.header.type == PacketType::kWriteMesh && !words.empty()) {
    write_mesh(words);
  }
}

void RecordedBoard::write(std::uint32_t address, std::uint32_t value) {
  if (is_configuration_register(address)) registers_[address] = value;
  // Frames in flight still come after the streams have been switched off.
  if (address == spec::kRegStreams && value != 0) streams_ = StreamSet::from_bits(value);
  if (address == spec::kRegControl && spec::kControlApply.get(value) != 0) apply();
}

void RecordedBoard::apply() {
  if (!id_ || !identity_) return;
  is_applying_ = true;
  auto made = std::make_shared<RecordedConfiguration>();
  made->configuration.build = identity_->build;
  for (const auto& [address, value] : registers_) {
    made->configuration.registers.push_back({address, value});
  }
  made->configuration.mesh = has_written_mesh() ? written_ : active_;
  // The first frame may come before the answer. An apply that is sent twice may take effect twice.
  configurations_[*id_ + 1] = std::move(made);
  if (configurations_.size() > kKeptConfigurations) configurations_.erase(configurations_.begin());
}

bool RecordedBoard::has_written_mesh() const {
  return !written_[0].empty() || !written_[1].empty();
}

void RecordedBoard::write_mesh(const std::vector<std::uint32_t>& words) {
  const std::uint32_t camera = spec::kMeshAddressCamera.get(words[0]);
  const std::size_t first = spec::kMeshAddressNode.get(words[0]);
  std::vector<std::uint32_t>& mesh = written_[camera % written_.size()];
  if (first == 0) mesh.clear();
  if (first > mesh.size()) return forget();  // nodes are missing
  mesh.resize(first);                        // a request may be sent twice
  mesh.insert(mesh.end(), words.begin() + 1, words.end());
  mesh_signature_ = link::mesh_signature(mesh, first, mesh.size() - first);
}

void RecordedBoard::add_from_board(const Packet& packet) {
  const auto values = unpack_registers(packet);
  if (!values) return;
  const std::uint16_t request = packet.header.index;
  if (std::count(requests_.begin(), requests_.end(), request) == 0) {
    forget();  // it answers another host
  } else if (request != requests_.back()) {
    return;  // it is late: the host has sent the request again
  }
  std::optional<std::uint32_t> id;
  bool is_identity = false;
  for (const RegisterWrite& each : *values) {
    if (is_configuration_register(each.address)) registers_[each.address] = each.value;
    if (each.address == spec::kRegConfiguration) id = each.value;
    is_identity |= each.address == spec::kRegIdentity;
    const bool is_wrong_mesh =
        each.address == spec::kRegMeshSignature && each.value != mesh_signature_;
    if (is_wrong_mesh) forget();
  }
  if (is_identity) {
    // The host starts anew: until it has configured the board, nobody knows what makes a frame.
    forget();
    identity_ = Identity::from_values(*values);
  }
  if (id) take_configuration_id(*id);
}

void RecordedBoard::take_configuration_id(std::uint32_t id) {
  const bool is_new = id_ && *id_ != id;
  id_ = id;
  if (!is_new) return;
  const auto made = configuration(id);
  const bool is_ours = std::exchange(is_applying_, false) && made;
  const auto& registers = is_ours ? made->configuration.registers : std::vector<RegisterWrite>();
  const bool is_held =
      is_ours && std::all_of(registers.begin(), registers.end(), [this](const RegisterWrite& each) {
        return registers_[each.address] == each.value;
      });
  if (!is_held) return forget();  // another host or a reset, or the board holds other values
  if (has_written_mesh()) active_ = std::exchange(written_, {});
}

void RecordedBoard::forget() {
  configurations_.clear();
  registers_.clear();
  written_ = active_ = {};
  is_applying_ = false;
  id_.reset();
}

std::shared_ptr<const RecordedConfiguration> RecordedBoard::configuration(std::uint32_t id) const {
  const auto after = configurations_.upper_bound(id);
  return after == configurations_.begin() ? nullptr : std::prev(after)->second;
}

}  // namespace fpga_stereo::link
