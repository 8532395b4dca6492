#include "core/printable.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace fpga_stereo {
namespace {

struct Character {
  std::size_t bytes = 1;
  bool is_printable = false;
};

/// Returns how many bytes a character has that begins with this byte; 0 if none does.
std::size_t length_of(std::uint8_t first) {
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0) return 2;
  if (first >= 0xE0 && first < 0xF0) return 3;
  if (first >= 0xF0 && first < 0xF5) return 4;
  return 0;
}

bool is_printable(std::uint32_t code) {
  const bool is_control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool is_direction = code == 0x200E || code == 0x200F ||
                            (code >= 0x2028 && code <= 0x202E) ||
                            (code >= 0x2066 && code <= 0x2069);
  const bool is_surrogate = code >= 0xD800 && code < 0xE000;
  return !is_control && !is_direction && !is_surrogate && code <= 0x10FFFF;
}

/// Decodes the first character of a text that is not empty. A byte that is not UTF-8 is a character
/// of its own.
Character first_character(std::string_view text) {
  constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};  // by length
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::size_t length = length_of(byte(0));
  if (length == 0 || length > text.size()) return {};
  std::uint32_t code = length == 1 ? byte(0) : byte(0) & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    code = code << 6U | (byte(i) & 0x3FU);
  }
  if (code < kSmallest[length]) return {};
  return {length, is_printable(code)};
}

}  // namespace

std::string printable(std::string_view text, std::size_t max_bytes) {
  std::string result;
  while (!text.empty()) {
    const Character character = first_character(text);
    std::string shown;
    if (character.is_printable) {
      shown = text.substr(0, character.bytes);
    } else {
      for (const char byte : text.substr(0, character.bytes)) {
        shown += fmt::format("\\x{:02x}", static_cast<std::uint8_t>(byte));
      }
    }
    if (result.size() + shown.size() > max_bytes) return result + "...";
    result += shown;
    text.remove_prefix(character.bytes);
  }
  return result;
}

}  // namespace fpga_stereo
