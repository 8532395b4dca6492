// Lists of registers and their values.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "fpga_stereo/core/gateware_configuration.hpp"

namespace fpga_stereo::link {

/// Returns the value of the register at `address`; 0 if the list lacks it.
inline std::uint32_t value_of(const std::vector<RegisterWrite>& values, std::uint32_t address) {
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const RegisterWrite& v) { return v.address == address; });
  return found == values.end() ? 0 : found->value;
}

inline std::vector<std::uint32_t> addresses_of(const std::vector<RegisterWrite>& values) {
  std::vector<std::uint32_t> addresses;
  addresses.reserve(values.size());
  for (const RegisterWrite& v : values) addresses.push_back(v.address);
  return addresses;
}

}  // namespace fpga_stereo::link
