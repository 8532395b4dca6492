#include "fpga_stereo/link/identity.hpp"

#include <sstream>

#include "link/packet.hpp"

namespace fpga_stereo::link {
namespace {

constexpr const char* kFlash =
    "flash the gateware of this release (rosrun fpga_stereo board flash), or install the software "
    "that belongs to that gateware";

std::string version(int major, int minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}

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
                 "what answers is no board of this kind: IDENTITY = " + hex(identity) +
                     ", expected " + hex(spec::kRegIdentityReset)};
  }
  const auto ours = static_cast<int>(spec::kVersionMajor.get(spec::kRegVersionReset));
  if (major != ours) {
    return Error{ErrorKind::kIncompatible,
                 "the board's gateware has version " + version(major, minor) +
                     ", this software works with " + std::to_string(ours) + ".x: " + kFlash};
  }
  if (spec_hash != kSpecHash) {
    return Error{ErrorKind::kIncompatible, "the board's gateware is of specification " +
                                               hex(spec_hash) + ", this software of " +
                                               hex(kSpecHash) + ": " + kFlash};
  }
  return {};
}

std::string Identity::text() const {
  std::ostringstream text;
  text << "gateware " << version(major, minor) << ", " << build.max_width << " px wide, "
       << build.disparities << " disparities, " << to_text(build.census_pattern) << " census "
       << build.census_window << ", correlation " << build.correlation_window << ", "
       << build.line_rows << " rows of line buffer, " << clock_hz / 1e6 << " MHz";
  return text.str();
}

std::string version_text(int version) {
  return "the board speaks version " + std::to_string(version) +
         " of the packets, this software version " + std::to_string(kVersion) + ": " + kFlash;
}

}  // namespace fpga_stereo::link
