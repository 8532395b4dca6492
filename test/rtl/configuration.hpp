// Accesses the ports `config_i` of the stages and `config_o` of fs_registers in Verilated models.
// Both hold the configuration registers side by side, one word each.
#pragma once

#include <cstdint>

#include "fpga_stereo/core/gateware_configuration.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::test {

/// Returns the index of a configuration register's word in the port.
inline int config_word(std::uint32_t address) {
  return static_cast<int>(address - spec::kRegWidth);
}

/// Sets the parameters in `config_i` of a model and every other field to 0.
template <class Model>
void set_config(Model& model, const Parameters& parameters) {
  for (auto& word : model.config_i.m_storage) word = 0;
  for (const RegisterWrite& write : parameter_registers(parameters)) {
    model.config_i[config_word(write.address)] = write.value;
  }
}

}  // namespace fpga_stereo::test
