#include "fpga_stereo/core/gateware_configuration.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {
namespace {

template <class... Parts>
Error refusal(ErrorKind kind, const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return {kind, text.str()};
}

template <class Value>
Status check_same(const char* name, const Value& wanted, const Value& built) {
  if (wanted == built) return {};
  return refusal(ErrorKind::kInvalid, name, " = ", wanted, ": this gateware is built for ", built,
                 " only");
}

Status check_range(const char* name, int value, int min, int max) {
  if (value >= min && value <= max) return {};
  return refusal(ErrorKind::kImageSize, name, " = ", value, ": this gateware allows ", min, " to ",
                 max);
}

/// What a camera needs of the line buffer of a gateware if reading starts at `start`.
LineBufferNeed gateware_need(const CameraRectification& camera, std::int64_t start) {
  LineBufferNeed need = camera.line_buffer;
  const int width = camera.mesh.size.width;
  // What is read later is kept longer, and the row that is being written holds pixels of two rows
  // of the image.
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

GatewareBuild GatewareBuild::from_registers(std::uint32_t build, std::uint32_t line_rows,
                                            std::uint32_t mesh_nodes) {
  const auto field = [build](spec::Field f) { return static_cast<int>(f.get(build)); };
  GatewareBuild made;
  made.max_width = field(spec::kBuildMaxWidth);
  made.disparities = field(spec::kBuildDisparities);
  if (made.disparities == 0) made.disparities = 1 << spec::kBuildDisparities.bits;
  made.census_window = field(spec::kBuildCensusWindow);
  made.correlation_window = field(spec::kBuildCorrelationWindow);
  made.census_pattern =
      field(spec::kBuildCensusFull) != 0 ? CensusPattern::kFull : CensusPattern::kSparse;
  made.line_rows = static_cast<int>(line_rows);
  made.mesh_nodes = static_cast<int>(mesh_nodes);
  return made;
}

std::uint32_t GatewareBuild::build_register() const {
  const auto put = [](spec::Field f, int value) {
    return f.put(static_cast<std::uint32_t>(value));
  };
  return put(spec::kBuildMaxWidth, max_width) | put(spec::kBuildDisparities, disparities) |
         put(spec::kBuildCensusWindow, census_window) |
         put(spec::kBuildCorrelationWindow, correlation_window) |
         put(spec::kBuildCensusFull, census_pattern == CensusPattern::kFull ? 1 : 0);
}

bool GatewareBuild::operator==(const GatewareBuild& other) const {
  return build_register() == other.build_register() && line_rows == other.line_rows &&
         mesh_nodes == other.mesh_nodes;
}

Parameters parameters_of(const GatewareBuild& build) {
  Parameters parameters;
  parameters.disparity_range = build.disparities;
  parameters.census_window_size = build.census_window;
  parameters.census_pattern = build.census_pattern;
  parameters.correlation_window_size = build.correlation_window;
  return parameters;
}

std::vector<RegisterWrite> parameter_registers(const Parameters& p) {
  return {
      {spec::kRegFlags, spec::kFlagsLeftRightCheck.put(p.left_right_check) |
                            spec::kFlagsUniquenessCheck.put(p.uniqueness_check) |
                            spec::kFlagsSubpixel.put(p.subpixel)},
      {spec::kRegDisp12MaxDiff, spec::kDisp12MaxDiffPixels.put(p.disp12MaxDiff)},
      {spec::kRegUniqueness, spec::kUniquenessFactor.put(uniqueness_factor(p))},
      {spec::kRegSpeckleSize, spec::kSpeckleSizePixels.put(p.speckle_size)},
      {spec::kRegSpeckleRange, spec::kSpeckleRangeUnits.put(p.speckle_range * kDisparityScale)},
  };
}

std::string hex(std::uint32_t value) {
  std::ostringstream text;
  text << "0x" << std::uppercase << std::hex << std::setw(8) << std::setfill('0') << value;
  return text.str();
}

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
      check_same("disparity_range", p.disparity_range, build.disparities),
      check_same("census_window_size", p.census_window_size, build.census_window),
      check_same("census_pattern", to_text(p.census_pattern), to_text(build.census_pattern)),
      check_same("correlation_window_size", p.correlation_window_size, build.correlation_window),
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
