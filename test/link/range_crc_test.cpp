#include "link/range_crc.hpp"

#include <gtest/gtest.h>

#include <random>

#include "link/packet.hpp"

namespace fpga_stereo::test {
namespace {

std::vector<std::uint8_t> random_bytes(std::size_t size, std::mt19937& random) {
  std::vector<std::uint8_t> bytes(size);
  for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

TEST(RangeCrc, EqualsTheCrcOfEveryRange) {
  std::mt19937 random(1);
  const auto bytes = random_bytes(20000, random);
  link::RangeCrc crc;
  for (int i = 0; i < 3000; ++i) {
    const std::size_t size = 4 * (random() % (1 + link::kMaxPayloadBytes / 4));
    const std::size_t begin = random() % (bytes.size() - size);
    ASSERT_EQ(crc.of(bytes.data(), begin, begin + size), link::crc32c(&bytes[begin], size))
        << begin << " " << size;
  }
}

TEST(RangeCrc, FollowsABufferWhoseStartIsRemoved) {
  std::mt19937 random(2);
  auto bytes = random_bytes(200000, random);
  link::RangeCrc crc;
  std::size_t begin = 0;
  while (bytes.size() > 30000) {
    begin += random() % 50;
    const std::size_t size = 4 * (random() % 2000);
    ASSERT_EQ(crc.of(bytes.data(), begin, begin + size), link::crc32c(&bytes[begin], size));
    if (random() % 10 != 0) continue;
    const std::size_t removed = random() % (begin + 1);
    bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(removed));
    crc.remove(removed);
    begin -= removed;
  }
}

}  // namespace
}  // namespace fpga_stereo::test
