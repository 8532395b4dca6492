// The number of bits set in a word.
#pragma once

#include <cstdint>

namespace fpga_stereo {

/// Returns the number of bits set in a word, in steps that every compiler can vectorise
/// (H. S. Warren, "Hacker's Delight", 5-1).
constexpr std::uint32_t popcount(std::uint32_t v) {
  v -= (v >> 1) & 0x55555555U;
  v = (v & 0x33333333U) + ((v >> 2) & 0x33333333U);
  v = (v + (v >> 4)) & 0x0F0F0F0FU;
  v += v >> 8;
  v += v >> 16;
  return v & 0x3FU;
}

}  // namespace fpga_stereo
