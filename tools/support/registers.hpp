// Finds registers and fields by name and parses their values.
#pragma once

#include <cstdint>
#include <string>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::tools {

/// Returns the register with this name. Throws UsageError that suggests similar names.
const spec::Register& find_register(const std::string& name);
/// Returns the field of a register with this name. Throws UsageError that suggests similar names.
const spec::FieldInfo& find_field(const spec::Register& reg, const std::string& name);

/// Parses a decimal or 0x... number up to `max`. Throws UsageError, which calls the value `name`.
std::uint32_t parse_value(const std::string& name, const std::string& text, std::uint32_t max);

}  // namespace fpga_stereo::tools
