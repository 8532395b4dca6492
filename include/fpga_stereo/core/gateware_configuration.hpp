// Converts the pipeline's parameters and meshes to the registers of a gateware and back. The
// registers are in fpga_fw/spec/registers.md; a link or a simulation writes them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// What a gateware was built for: its registers BUILD, BUILD_LINE_ROWS, BUILD_MESH_NODES.
struct GatewareBuild {
  int max_width = kDefaultMaxWidth;                    // px
  int disparities = kDefaultDisparities;               // disparity_range
  int census_window = kDefaultCensusWindow;            // px
  int correlation_window = kDefaultCorrelationWindow;  // px
  CensusPattern census_pattern = CensusPattern::kSparse;
  int line_rows = kDefaultLineRows;    // rows of each line buffer
  int mesh_nodes = kDefaultMeshNodes;  // nodes that one mesh may have

  /// Returns the width of the narrowest image, px.
  int min_width() const;
  /// Refuses what no gateware is built for, by name, value and range: a board may say anything.
  Status check() const;

  /// Returns the build that the registers BUILD, BUILD_LINE_ROWS and BUILD_MESH_NODES describe.
  static GatewareBuild from_registers(std::uint32_t build, std::uint32_t line_rows,
                                      std::uint32_t mesh_nodes);
  /// Returns the value of the register BUILD.
  std::uint32_t build_register() const;
  bool operator==(const GatewareBuild& other) const;
};

/// Returns the parameters that the build fixes; the others have their defaults.
Parameters parameters_of(const GatewareBuild& build);

/// A value for a register.
struct RegisterWrite {
  std::uint32_t address;  // of the word
  std::uint32_t value;
};

/// Returns the configuration registers that hold parameters, in ascending address order.
std::vector<RegisterWrite> parameter_registers(const Parameters& parameters);

/// Returns the fields of BUILD that hold parameters.
std::uint32_t build_fields(const Parameters& parameters);

/// Sets the parameters that the register at this word address holds. Ignores other registers.
void set_parameters(Parameters& parameters, std::uint32_t address, std::uint32_t word);

/// Returns the value of a register as text: "0x0000001F".
std::string hex(std::uint32_t value);

/// Returns the delay T_s of rectify, in pixels, that suits the meshes of both cameras. It is at
/// least a row and two pixels, so an identity mesh works too.
std::int64_t read_start(const StereoRectification& rectification);

/// Returns the rows that each line buffer of a gateware must have.
int line_rows(const StereoRectification& rectification);

/// Refuses the first setting that a gateware of this build cannot have, by name, value and range.
Status check_build(const GatewareBuild& build, const Parameters& parameters,
                   const StereoRectification& rectification);

/// Registers and meshes that configure a gateware.
struct GatewareConfiguration {
  GatewareBuild build;                             // it suits gatewares of this build only
  std::vector<RegisterWrite> registers;            // the shadow configuration
  std::array<std::vector<std::uint32_t>, 2> mesh;  // left, right: words for MESH_DATA, one per node

  /// Returns all register writes in order; the last one is CONTROL.apply.
  std::vector<RegisterWrite> writes() const;
};

/// Returns the configuration, or the error of check_build().
Result<GatewareConfiguration> make_gateware_configuration(const GatewareBuild& build,
                                                          const Parameters& parameters,
                                                          const StereoRectification& rectification);

}  // namespace fpga_stereo
