#include "sim/virtual_board/board_registers.hpp"

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::sim {
namespace {

Mesh to_mesh(cv::Size size, const std::vector<std::uint32_t>& words) {
  Mesh mesh;
  mesh.size = size;
  mesh.nodes.create(Mesh::node_count(size));
  std::size_t at = 0;
  for (cv::Vec2s& node : mesh.nodes) {
    const std::uint32_t word = words[at++];
    node = {static_cast<std::int16_t>(spec::kMeshDataDx.get(word)),
            static_cast<std::int16_t>(spec::kMeshDataDy.get(word))};
  }
  return mesh;
}

CameraRectification to_rectification(cv::Size size, const std::vector<std::uint32_t>& words) {
  CameraRectification rectification;
  rectification.mesh = to_mesh(size, words);
  rectification.line_buffer = line_buffer_need(rectification.mesh, size);
  return rectification;
}

}  // namespace

void BoardRegisters::reset() {
  for (const spec::Register& r : spec::register_table()) values_[r.address] = r.reset.value_or(0);
  values_[spec::kRegBuild] = options_.build.build_register();
  values_[spec::kRegBuildLineRows] = static_cast<std::uint32_t>(options_.build.line_rows);
  values_[spec::kRegBuildMeshNodes] = static_cast<std::uint32_t>(options_.build.mesh_nodes);
  values_[spec::kRegBuildStreams] = options_.streams.bits();
  values_[spec::kRegBuildClock] = options_.clock_hz;
  for (const auto& [address, value] : options_.overrides) values_[address] = value;
  for (auto& mesh : mesh_) mesh.assign(static_cast<std::size_t>(options_.build.mesh_nodes), 0);
  mesh_signature_ = Signature();
  active_ = {};
}

std::uint32_t BoardRegisters::read(std::uint32_t address) const {
  const bool is_write_only = address == spec::kRegControl || address == spec::kRegMeshData;
  return address < values_.size() && !is_write_only ? values_[address] : 0;
}

void BoardRegisters::write(std::uint32_t address, std::uint32_t value) {
  if (address >= values_.size() || options_.overrides.count(address) != 0) return;
  const bool is_shadow =
      (address >= spec::kConfigurationBegin && address < spec::kConfigurationEnd) ||
      address == spec::kRegMeshData;
  if (is_shadow) values_[spec::kRegStatus] &= ~spec::kStatusPending.mask();  // withdraws the apply
  switch (address) {
    case spec::kRegMeshData:
      return write_mesh(value);
    case spec::kRegControl:
      return write_control(value);
    case spec::kRegErrors:
      values_[address] &= ~value;
      return;
    default:
      return write_value(address, value);
  }
}

void BoardRegisters::write_mesh(std::uint32_t word) {
  const std::uint32_t at = values_[spec::kRegMeshAddress];
  auto& mesh = mesh_[spec::kMeshAddressCamera.get(at)];
  const std::uint32_t node = spec::kMeshAddressNode.get(at);
  if (node < mesh.size()) {
    mesh[node] = word;
    values_[spec::kRegStatus] |= spec::kStatusUploading.mask();
  }
  values_[spec::kRegMeshAddress] =
      (at & ~spec::kMeshAddressNode.mask()) | spec::kMeshAddressNode.put(node + 1);
  mesh_signature_.add(word);
  if (options_.overrides.count(spec::kRegMeshSignature) != 0) return;
  values_[spec::kRegMeshSignature] = mesh_signature_.value();
}

void BoardRegisters::write_control(std::uint32_t value) {
  if (spec::kControlClear.get(value) != 0) clear_counters();
  if (spec::kControlApply.get(value) == 0) return;
  values_[spec::kRegStatus] |= spec::kStatusPending.mask();
  if (!is_frame_held_) apply();
}

void BoardRegisters::clear_counters() {
  for (std::uint32_t r = spec::kRegFramesIn; r <= spec::kRegMeshUploads; ++r) values_[r] = 0;
  for (const std::uint32_t r : {spec::kRegErrors, spec::kRegFramesDropped, spec::kRegBadPackets,
                                spec::kRegLostPackets, spec::kRegInputErrors}) {
    values_[r] = 0;
  }
}

void BoardRegisters::write_value(std::uint32_t address, std::uint32_t value) {
  for (const spec::Register& r : spec::register_table()) {
    if (r.address != address || r.access != spec::Access::kReadWrite) continue;
    std::uint32_t mask = r.fields.empty() ? ~0U : 0;
    for (const spec::FieldInfo& f : r.fields) mask |= f.field.mask();
    // The RTL has no flip-flops for streams that the build lacks.
    if (address == spec::kRegStreams) mask &= options_.streams.bits();
    values_[address] = value & mask;
  }
  if (address != spec::kRegMeshAddress) return;
  mesh_signature_ = Signature();
  if (options_.overrides.count(spec::kRegMeshSignature) != 0) return;
  values_[spec::kRegMeshSignature] = mesh_signature_.value();
}

void BoardRegisters::hold_frame(bool is_held) {
  is_frame_held_ = is_held;
  if (!is_held && spec::kStatusPending.get(values_[spec::kRegStatus]) != 0) apply();
}

bool BoardRegisters::is_uploading() const {
  return spec::kStatusUploading.get(values_[spec::kRegStatus]) != 0;
}

int BoardRegisters::field(std::uint32_t address, spec::Field field) const {
  return static_cast<int>(field.get(values_[address]));
}

bool BoardRegisters::is_applicable(cv::Size size) const {
  const GatewareBuild& build = options_.build;
  return size.width >= build.min_width() && size.width <= build.max_width && size.height >= 1 &&
         size.height <= kGatewareMaxHeight &&
         field(spec::kRegReadStart, spec::kReadStartPixels) < size.width &&
         field(spec::kRegReadStart, spec::kReadStartRows) < build.line_rows;
}

Parameters BoardRegisters::parameters() const {
  Parameters parameters = parameters_of(options_.build);
  for (const spec::Register& r : spec::register_table()) {
    set_parameters(parameters, r.address, values_[r.address]);
  }
  return parameters;
}

void BoardRegisters::apply() {
  values_[spec::kRegStatus] &= ~spec::kStatusPending.mask();
  const cv::Size size(field(spec::kRegWidth, spec::kWidthPixels),
                      field(spec::kRegHeight, spec::kHeightRows));
  if (!is_applicable(size)) {
    values_[spec::kRegErrors] |= spec::kErrorsConfig.mask();
    return;
  }
  if (is_uploading()) ++values_[spec::kRegMeshUploads];
  values_[spec::kRegStatus] &= ~spec::kStatusUploading.mask();
  active_.parameters = parameters();
  active_.rectification.geometry.image_size = size;
  active_.rectification.left = to_rectification(size, mesh_[0]);
  active_.rectification.right = to_rectification(size, mesh_[1]);
  active_.is_buffer_too_small = line_rows(active_.rectification) > options_.build.line_rows;
  ++values_[spec::kRegConfiguration];
}

}  // namespace fpga_stereo::sim
