// Accesses to the register bus of fs_registers in a Verilated model.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

namespace fpga_stereo::test {

/// Writes one register; `clock()` must run one clock of `model`.
template <class Model, class Clock>
void write_register(Model& model, const Clock& clock, std::uint32_t address, std::uint32_t data) {
  model.write_i = 1;
  model.address_i = address;
  model.data_i = data;
  clock();
  model.write_i = 0;
}

/// Reads one register; the value is valid one clock after the address.
template <class Model, class Clock>
std::uint32_t read_register(Model& model, const Clock& clock, std::uint32_t address) {
  model.read_i = 1;
  model.address_i = address;
  clock();
  model.read_i = 0;
  EXPECT_TRUE(model.read_valid_o);
  return model.data_o;
}

}  // namespace fpga_stereo::test
