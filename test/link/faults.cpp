#include "link/faults.hpp"

#include <algorithm>

#include "link/packet.hpp"

namespace fpga_stereo::test {
namespace {

Bytes rubbish(std::size_t size, std::mt19937& random) {
  Bytes bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

}  // namespace

void damage(Bytes& bytes, std::size_t begin, std::size_t end, Fault fault, std::mt19937& random) {
  const std::size_t offset = begin + random() % (end - begin);
  const auto at = bytes.begin() + static_cast<std::ptrdiff_t>(offset);
  const std::size_t run = 1 + random() % std::min<std::size_t>(600, end - offset);
  const auto run_end = at + static_cast<std::ptrdiff_t>(run);
  Bytes extra;
  switch (fault) {
    case Fault::kBitFlip:
      *at = static_cast<std::uint8_t>(*at ^ 1U << random() % 8);
      return;
    case Fault::kByteLost:
      bytes.erase(at);
      return;
    case Fault::kRunLost:
      bytes.erase(at, run_end);
      return;
    case Fault::kZeros:
      std::fill(at, run_end, std::uint8_t{0});
      return;
    case Fault::kByteInserted:
      extra = rubbish(1, random);
      break;
    case Fault::kByteDoubled:
      extra = {*at};
      break;
    case Fault::kRunDoubled:
      extra.assign(at, run_end);
      break;
    case Fault::kGarbage:
      extra = rubbish(1 + random() % 600, random);
      break;
    case Fault::kFakeSync:
      extra = rubbish(4 + random() % 60, random);
      link::put_u32(extra.data(), link::kSync);
      break;
    case Fault::kFakeHeader: {
      link::Header header;
      header.length = static_cast<std::uint16_t>(4 + 4 * (random() % 2048));
      const auto packed = link::pack(header);
      extra.assign(packed.begin(), packed.end());
      break;
    }
  }
  bytes.insert(at, extra.begin(), extra.end());
}

}  // namespace fpga_stereo::test
