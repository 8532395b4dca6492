// Damages bytes as USB and serial lines do.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace fpga_stereo::test {

using Bytes = std::vector<std::uint8_t>;

enum class Fault {
  kBitFlip,
  kByteLost,
  kByteInserted,
  kByteDoubled,
  kRunLost,  // up to 600 bytes
  kRunDoubled,
  kGarbage,     // random bytes are inserted
  kFakeSync,    // a sync word and random bytes
  kFakeHeader,  // an intact header without its payload
  kZeros,       // some bytes become 0
};
constexpr int kNumFaults = 10;

/// Applies the fault to `bytes` somewhere in [begin, end). Bytes outside are moved at most.
void damage(Bytes& bytes, std::size_t begin, std::size_t end, Fault fault, std::mt19937& random);

}  // namespace fpga_stereo::test
