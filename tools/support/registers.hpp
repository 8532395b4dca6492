// Registers by name, as people write and read them.
#pragma once

#include <cstdint>
#include <string>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::tools {

/// Throws UsageError that names registers which are called nearly so.
const spec::Register& find_register(const std::string& name);
/// The same for a field of a register.
const spec::FieldInfo& find_field(const spec::Register& reg, const std::string& name);

/// Decimal or 0x..., up to `max`. Throws UsageError; `name` is what was to get the value.
std::uint32_t parse_value(const std::string& name, const std::string& text, std::uint32_t max);

}  // namespace fpga_stereo::tools
