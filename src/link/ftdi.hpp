// The protocol of an FT232H: status bytes in received data, and its EEPROM.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo::link {

/// The vendor request that reads a word of the EEPROM.
constexpr std::uint8_t kReadEeprom = 0x90;

/// The payload of a transfer.
struct Stripped {
  std::size_t size = 0;   // bytes of payload, moved to the front
  unsigned overruns = 0;  // packets before which the chip lost bytes
};

/// Removes the two status bytes at the start of every packet. `bytes` is one bulk transfer: packets
/// of `packet` bytes (wMaxPacketSize), of which the last may be shorter.
Stripped strip_status(std::uint8_t* bytes, std::size_t size, std::size_t packet);

/// Checks word 0 of the EEPROM: the chip must be set to 245 FIFO mode. `device` names it in the
/// error.
Status check_fifo_mode(std::uint16_t eeprom_word, const std::string& device);

}  // namespace fpga_stereo::link
