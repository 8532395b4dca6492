// What an FT232H puts between the host and its FIFO.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo::link {

/// What was left of a transfer.
struct Stripped {
  std::size_t size = 0;   // bytes of payload, moved to the front
  unsigned overruns = 0;  // packets before which the chip had lost bytes
};

/// Takes the two status bytes off the start of every packet. `bytes` is one bulk transfer, which
/// begins with a packet and has `packet` bytes (wMaxPacketSize) in every one but the last.
Stripped strip_status(std::uint8_t* bytes, std::size_t size, std::size_t packet);

/// Whether the chip is set to 245 FIFO mode, by word 0 of its EEPROM; `device` is for the message.
Status check_fifo_mode(std::uint16_t eeprom_word, const std::string& device);

}  // namespace fpga_stereo::link
