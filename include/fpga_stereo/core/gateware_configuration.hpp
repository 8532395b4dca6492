// From the pipeline's parameters and meshes to the registers of a gateware, whoever carries them
// there. fpga_fw/spec/registers.md has the registers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"

namespace fpga_stereo {

/// What a gateware was built for: its registers BUILD, BUILD_LINE_ROWS, BUILD_MESH_NODES.
struct GatewareBuild {
  int max_width = 0;           // px
  int disparities = 0;         // disparity_range
  int census_window = 0;       // px
  int correlation_window = 0;  // px
  CensusPattern census_pattern = CensusPattern::kSparse;
  int line_rows = 0;   // of the line buffer
  int mesh_nodes = 0;  // of a mesh

  /// The narrowest image, px.
  int min_width() const;

  /// From the registers BUILD, BUILD_LINE_ROWS, BUILD_MESH_NODES.
  static GatewareBuild from_registers(std::uint32_t build, std::uint32_t line_rows,
                                      std::uint32_t mesh_nodes);
  /// The register BUILD.
  std::uint32_t build_register() const;
  bool operator==(const GatewareBuild& other) const;
};

/// Default parameters, but for those that the build fixes.
Parameters parameters_of(const GatewareBuild& build);

struct RegisterWrite {
  std::uint32_t address;  // of the word
  std::uint32_t value;
};

/// Returns the configuration registers that hold parameters, in ascending address order.
std::vector<RegisterWrite> parameter_registers(const Parameters& parameters);

/// The value of a register for people: "0x0000001F".
std::string hex(std::uint32_t value);

/// T_s for both cameras: what their meshes need, and at least a row and two pixels, with which a
/// mesh that moves nothing works, too.
std::int64_t read_start(const StereoRectification& rectification);

/// Rows that the line buffer of a gateware must have for both cameras.
int line_rows(const StereoRectification& rectification);

/// Refuses what a gateware of this build cannot do, by name, value and what is allowed.
Status check_build(const GatewareBuild& build, const Parameters& parameters,
                   const StereoRectification& rectification);

/// Everything that configures a gateware.
struct GatewareConfiguration {
  GatewareBuild build;                             // that it was made for
  std::vector<RegisterWrite> registers;            // the shadow
  std::array<std::vector<std::uint32_t>, 2> mesh;  // left, right: the words for MESH_DATA

  /// As one list of writes, the last of which is CONTROL.apply.
  std::vector<RegisterWrite> writes() const;
};

/// What check_build() refuses is refused.
Result<GatewareConfiguration> make_gateware_configuration(const GatewareBuild& build,
                                                          const Parameters& parameters,
                                                          const StereoRectification& rectification);

}  // namespace fpga_stereo
