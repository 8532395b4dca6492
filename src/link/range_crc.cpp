#include "link/range_crc.hpp"

#include <array>

#include "link/packet.hpp"

namespace fpga_stereo::link {
namespace {

// Registers hold polynomials over GF(2), reflected: the highest bit is the coefficient of x^0.
constexpr std::uint32_t kPolynomial = 0x82F63B78;
constexpr std::uint32_t kOne = 0x80000000;
constexpr std::size_t kMaxWords = (kCrcBytes + kMaxPayloadBytes) / 4;

std::uint32_t times_x(std::uint32_t a) { return (a & 1U) != 0 ? (a >> 1U) ^ kPolynomial : a >> 1U; }

std::uint32_t product(std::uint32_t a, std::uint32_t b) {
  std::uint32_t result = 0;
  for (; a != 0; a <<= 1U, b = times_x(b)) {
    if ((a & kOne) != 0) result ^= b;
  }
  return result;
}

/// Returns the register after a byte, by that byte, from a register of 0.
std::array<std::uint32_t, 256> make_bytes() {
  std::array<std::uint32_t, 256> bytes{};
  for (std::uint32_t byte = 0; byte < bytes.size(); ++byte) {
    bytes[byte] = byte;
    for (int bit = 0; bit < 8; ++bit) bytes[byte] = times_x(bytes[byte]);
  }
  return bytes;
}

/// Returns x^(32 n) by n: what n words of zeros multiply a register by.
std::array<std::uint32_t, kMaxWords + 1> make_powers() {
  std::array<std::uint32_t, kMaxWords + 1> powers{};
  powers[0] = kOne;
  for (std::size_t n = 1; n < powers.size(); ++n) {
    powers[n] = powers[n - 1];
    for (int bit = 0; bit < 32; ++bit) powers[n] = times_x(powers[n]);
  }
  return powers;
}

}  // namespace

std::uint32_t RangeCrc::of(const std::uint8_t* bytes, std::size_t begin, std::size_t end) {
  static const auto kBytes = make_bytes();
  static const auto kPowers = make_powers();
  if (registers_.empty() || begin < first_ || begin >= first_ + registers_.size()) {
    registers_.assign(1, 0);
    first_ = begin;
  }
  for (std::size_t at = first_ + registers_.size() - 1; at < end; ++at) {
    const std::uint32_t last = registers_.back();
    registers_.push_back((last >> 8U) ^ kBytes[(last ^ bytes[at]) & 0xFFU]);
  }
  const std::uint32_t before = registers_[begin - first_], after = registers_[end - first_];
  constexpr std::uint32_t kAllOnes = 0xFFFFFFFF;
  return ~(product(before ^ kAllOnes, kPowers[(end - begin) / 4]) ^ after);
}

void RangeCrc::remove(std::size_t size) {
  if (size >= first_ + registers_.size()) return clear();
  if (size > first_) {
    registers_.erase(registers_.begin(),
                     registers_.begin() + static_cast<std::ptrdiff_t>(size - first_));
    first_ = 0;
  } else {
    first_ -= size;
  }
}

void RangeCrc::clear() { registers_.clear(); }

}  // namespace fpga_stereo::link
