#include "fpga_stereo/core/gateware_configuration.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {
namespace {

/// Refuses the first parameter that has another value than the one that the gateware is built for.
Status check_parameters(const GatewareBuild& build, const Parameters& parameters) {
  const Parameters built = parameters_of(build);
  const bool is_sgm = parameters.stereo_algorithm == StereoAlgorithm::kSgm;
  for (const ParameterInfo& info : parameter_table()) {
    const std::string wanted = to_text(parameters, info), have = to_text(built, info);
    if (!info.is_fixed_by_build || wanted == have) continue;
    if (info.name == "sgm_build" && !is_sgm) continue;  // it has no effect
    return Error{ErrorKind::kInvalid, fmt::format("{} = {}: this gateware is built for {} only",
                                                  info.name, wanted, have)};
  }
  return {};
}

Status check_range(const char* name, int value, int min, int max) {
  if (value >= min && value <= max) return {};
  return Error{ErrorKind::kImageSize,
               fmt::format("{} = {}: this gateware allows {} to {}", name, value, min, max)};
}

/// Returns what a camera needs of the gateware's line buffer if reading starts at `start`.
LineBufferNeed gateware_need(const CameraRectification& camera, std::int64_t start) {
  LineBufferNeed need = camera.line_buffer;
  const int width = camera.mesh.size.width;
  // A later start keeps rows longer, and the row being written holds pixels of two image rows.
  need.rows += static_cast<int>((start - need.read_start + width - 1) / width) + 1;
  need.rows_below = std::max(need.rows_below, static_cast<int>((start - 1) / width));
  return need;
}

std::vector<std::uint32_t> mesh_words(const Mesh& mesh) {
  std::vector<std::uint32_t> words;
  words.reserve(mesh.nodes.total());
  for (const cv::Vec2s& node : mesh.nodes) {
    words.push_back(spec::kMeshDataDx.put(static_cast<std::uint16_t>(node[0])) |
                    spec::kMeshDataDy.put(static_cast<std::uint16_t>(node[1])));
  }
  return words;
}

}  // namespace

int GatewareBuild::min_width() const { return std::max(kGatewareMinWidth, correlation_window + 1); }

Status GatewareBuild::check() const {
  constexpr int kMaxNodes = 1 << spec::kMeshAddressNode.bits;
  const auto check = [](const char* name, int value, int min, int max) -> Status {
    if (value >= min && value <= max) return {};
    return Error{ErrorKind::kIncompatible,
                 fmt::format("{} = {}: gatewares have {} to {}", name, value, min, max)};
  };
  const Status checks[]{
      validate(parameters_of(*this)),
      check("maximum image width", max_width, min_width(), kGatewareMaxWidth),
      check("rows of a line buffer", line_rows, 1, kGatewareMaxHeight),
      check("nodes of a mesh", mesh_nodes, 1, kMaxNodes),
  };
  for (const Status& status : checks) {
    if (!status) return Error{ErrorKind::kIncompatible, status.error().message};
  }
  return {};
}

GatewareBuild GatewareBuild::from_registers(std::uint32_t build, std::uint32_t line_rows,
                                            std::uint32_t mesh_nodes) {
  Parameters parameters = window_parameters();
  set_parameters(parameters, spec::kRegBuild, build);
  GatewareBuild made;
  made.max_width = static_cast<int>(spec::kBuildMaxWidth.get(build));
  made.disparities = parameters.disparity_range;
  made.census_window = parameters.census_window_size;
  made.correlation_window = parameters.correlation_window_size;
  made.census_pattern = parameters.census_pattern;
  made.line_rows = static_cast<int>(line_rows);
  made.mesh_nodes = static_cast<int>(mesh_nodes);
  return made;
}

std::uint32_t GatewareBuild::build_register() const {
  return spec::kBuildMaxWidth.put(static_cast<std::uint32_t>(max_width)) |
         build_fields(parameters_of(*this));
}

bool GatewareBuild::operator==(const GatewareBuild& other) const {
  return build_register() == other.build_register() && line_rows == other.line_rows &&
         mesh_nodes == other.mesh_nodes;
}

Parameters parameters_of(const GatewareBuild& build) {
  Parameters parameters = window_parameters();
  parameters.disparity_range = build.disparities;
  parameters.census_window_size = build.census_window;
  parameters.census_pattern = build.census_pattern;
  parameters.correlation_window_size = build.correlation_window;
  return parameters;
}

std::string hex(std::uint32_t value) { return fmt::format("0x{:08X}", value); }

std::int64_t read_start(const StereoRectification& rectification) {
  constexpr int kBilinear = 2;  // px right of where the lower pair of taps begins
  return std::max({rectification.left.line_buffer.read_start,
                   rectification.right.line_buffer.read_start,
                   std::int64_t{rectification.geometry.image_size.width} + kBilinear});
}

int line_rows(const StereoRectification& r) {
  const std::int64_t start = read_start(r);
  return std::max(gateware_need(r.left, start).rows, gateware_need(r.right, start).rows);
}

Status check_build(const GatewareBuild& build, const Parameters& p, const StereoRectification& r) {
  const cv::Size size = r.geometry.image_size;
  const cv::Size nodes = Mesh::node_count(size);
  const std::int64_t start = read_start(r);
  const Status checks[]{
      validate(p),
      check_parameters(build, p),
      check_range("image width", size.width, build.min_width(), build.max_width),
      check_range("image height", size.height, 1, kGatewareMaxHeight),
      check_range("nodes of a mesh", nodes.area(), 1, build.mesh_nodes),
      check_line_buffer(gateware_need(r.left, start), build.line_rows, "left"),
      check_line_buffer(gateware_need(r.right, start), build.line_rows, "right"),
  };
  for (const Status& status : checks) {
    if (!status) return status;
  }
  return {};
}

std::vector<RegisterWrite> GatewareConfiguration::writes() const {
  std::vector<RegisterWrite> all = registers;
  for (std::uint32_t right = 0; right < mesh.size(); ++right) {
    all.push_back({spec::kRegMeshAddress, spec::kMeshAddressCamera.put(right)});
    for (const std::uint32_t word : mesh[right]) all.push_back({spec::kRegMeshData, word});
  }
  all.push_back({spec::kRegControl, spec::kControlApply.put(1)});
  return all;
}

Result<GatewareConfiguration> make_gateware_configuration(const GatewareBuild& build,
                                                          const Parameters& p,
                                                          const StereoRectification& r) {
  if (const Status status = check_build(build, p, r); !status) return status.error();
  const cv::Size size = r.geometry.image_size;
  const auto start = static_cast<std::uint32_t>(read_start(r));
  const auto width = static_cast<std::uint32_t>(size.width);
  GatewareConfiguration made;
  made.build = build;
  made.registers = {
      {spec::kRegWidth, spec::kWidthPixels.put(width)},
      {spec::kRegHeight, spec::kHeightRows.put(size.height)},
      {spec::kRegReadStart,
       spec::kReadStartPixels.put(start % width) | spec::kReadStartRows.put(start / width)},
  };
  for (const RegisterWrite& write : parameter_registers(p)) made.registers.push_back(write);
  made.mesh = {mesh_words(r.left.mesh), mesh_words(r.right.mesh)};
  return made;
}

}  // namespace fpga_stereo
