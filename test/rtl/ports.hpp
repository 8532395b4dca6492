// Reads and writes bit fields of Verilated ports of any width.
#pragma once

#include <verilated.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <type_traits>

namespace fpga_stereo::test {

/// Returns bits lsb .. lsb + count - 1 of a port; count <= 32.
template <class Port>
std::uint32_t get_bits(const Port& port, int lsb, int count) {
  const std::uint64_t mask = (std::uint64_t{1} << count) - 1;
  if constexpr (std::is_integral_v<Port>) {
    return static_cast<std::uint32_t>((static_cast<std::uint64_t>(port) >> lsb) & mask);
  } else {
    std::uint64_t bits = port[lsb / 32];
    if (lsb % 32 + count > 32) bits |= static_cast<std::uint64_t>(port[lsb / 32 + 1]) << 32;
    return static_cast<std::uint32_t>((bits >> (lsb % 32)) & mask);
  }
}

/// Sets bits lsb .. lsb + count - 1 of a port to the low bits of `value`; count <= 32.
template <class Port>
void set_bits(Port& port, int lsb, int count, std::uint32_t value) {
  for (int bit = 0; bit < count; ++bit) {
    const std::uint64_t one = (value >> bit) & 1;
    const int at = lsb + bit;
    if constexpr (std::is_integral_v<Port>) {
      port = static_cast<Port>((static_cast<std::uint64_t>(port) & ~(std::uint64_t{1} << at)) |
                               (one << at));
    } else {
      port[at / 32] =
          (port[at / 32] & ~(1U << (at % 32))) | static_cast<std::uint32_t>(one << (at % 32));
    }
  }
}

/// Sets the lowest `count` bits of a port at random.
template <class Port>
void set_random(Port& port, int count, std::mt19937& random) {
  for (int lsb = 0; lsb < count; lsb += 32) {
    set_bits(port, lsb, std::min(32, count - lsb), random());
  }
}

}  // namespace fpga_stereo::test
