// The register bus of fs_registers, as models have it.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>

namespace fpga_stereo::test {

/// `clock()` makes one clock of `model`.
template <class Model, class Clock>
void write_register(Model& model, const Clock& clock, std::uint32_t address, std::uint32_t data) {
  model.write_i = 1;
  model.address_i = address;
  model.data_i = data;
  clock();
  model.write_i = 0;
}

/// The answer, which comes with the next clock.
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
