#include "fpga_stereo/link/identity.hpp"

#include <fmt/core.h>

#include "link/packet.hpp"

namespace fpga_stereo::link {
namespace {

constexpr const char* kFlash =
    "flash the gateware of this release (rosrun fpga_stereo board flash), or install the software "
    "that belongs to that gateware";

}  // namespace

std::vector<std::uint32_t> Identity::registers() {
  return {spec::kRegIdentity,     spec::kRegSpecHash,      spec::kRegVersion,
          spec::kRegBuild,        spec::kRegBuildLineRows, spec::kRegBuildMeshNodes,
          spec::kRegBuildStreams, spec::kRegBuildClock};
}

Identity Identity::from_values(const std::vector<RegisterWrite>& values) {
  const auto word = [&](std::uint32_t address) {
    for (const RegisterWrite& v : values) {
      if (v.address == address) return v.value;
    }
    return std::uint32_t{0};
  };
  Identity id;
  id.identity = word(spec::kRegIdentity);
  id.spec_hash = word(spec::kRegSpecHash);
  id.major = static_cast<int>(spec::kVersionMajor.get(word(spec::kRegVersion)));
  id.minor = static_cast<int>(spec::kVersionMinor.get(word(spec::kRegVersion)));
  id.build = GatewareBuild::from_registers(word(spec::kRegBuild), word(spec::kRegBuildLineRows),
                                           word(spec::kRegBuildMeshNodes));
  id.streams = StreamSet::from_bits(spec::kBuildStreamsStreams.get(word(spec::kRegBuildStreams)));
  id.clock_hz = word(spec::kRegBuildClock);
  return id;
}

Status Identity::check() const {
  if (identity != spec::kRegIdentityReset) {
    return Error{ErrorKind::kIncompatible,
                 fmt::format("the device is not an fpga_stereo board: IDENTITY = {}, expected {}",
                             hex(identity), hex(spec::kRegIdentityReset))};
  }
  const auto ours = static_cast<int>(spec::kVersionMajor.get(spec::kRegVersionReset));
  if (major != ours) {
    return Error{
        ErrorKind::kIncompatible,
        fmt::format("the board's gateware has version {}.{}, this software works with {}.x: {}",
                    major, minor, ours, kFlash)};
  }
  if (spec_hash != kSpecHash) {
    return Error{ErrorKind::kIncompatible,
                 fmt::format("the board's gateware was built for specification {}, "
                             "this software for {}: {}",
                             hex(spec_hash), hex(kSpecHash), kFlash)};
  }
  if (const Status possible = build.check(); !possible) {
    return Error{ErrorKind::kIncompatible,
                 fmt::format("the board claims an impossible build: {}: {}",
                             possible.error().message, kFlash)};
  }
  return {};
}

std::string Identity::text() const {
  return fmt::format(
      "gateware {}.{}, {} px wide, {} disparities, {} census {}, correlation {}, {} rows of line "
      "buffer, {:g} MHz",
      major, minor, build.max_width, build.disparities, to_text(build.census_pattern),
      build.census_window, build.correlation_window, build.line_rows, clock_hz / 1e6);
}

std::string version_text(int version) {
  return fmt::format("the board's packets have version {}, this software's have version {}: {}",
                     version, kVersion, kFlash);
}

}  // namespace fpga_stereo::link
