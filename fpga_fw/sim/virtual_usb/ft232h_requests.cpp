// The control requests of the virtual FT232H.
#include <cerrno>

#include "sim/virtual_usb/virtual_ft232h.hpp"

namespace fpga_stereo::sim {
namespace {

constexpr std::uint8_t kReset = 0x00, kFlowControl = 0x02, kBaudRate = 0x03, kModemStatus = 0x05;
constexpr std::uint8_t kSetLatency = 0x09, kGetLatency = 0x0A, kBitMode = 0x0B, kReadEeprom = 0x90;

}  // namespace

int VirtualFt232h::control(const Setup& setup, std::vector<std::uint8_t>& bytes) {
  if (are_requests_held_) return kHold;
  if (failing_requests_.count(setup.request) > 0) return -EPIPE;
  if (setup.type == 0x40) return vendor_out(setup);
  if (setup.type == 0xC0) return vendor_in(setup, bytes);
  if (setup.type == 0x80 && setup.request == 6 && setup.value >> 8 == 3) {
    return string_descriptor(setup, bytes);
  }
  return -EPIPE;
}

int VirtualFt232h::vendor_out(const Setup& setup) {
  switch (setup.request) {
    case kReset:
      if (setup.value == 0) {
        ++seen_.resets;
      } else {
        ++seen_.purges;
      }
      clear_fifo();
      return 0;
    case kFlowControl:
      seen_.flow_control = setup.index & 0xFF00;
      return 0;
    case kBaudRate:
      return 0;
    case kSetLatency:
      if (setup.value < 1 || setup.value > 255) return -EPIPE;
      seen_.latency_ms = setup.value;
      return 0;
    case kBitMode:
      seen_.bit_mode = setup.value >> 8;
      wake();
      return 0;
    default:
      return -EPIPE;
  }
}

int VirtualFt232h::vendor_in(const Setup& setup, std::vector<std::uint8_t>& bytes) const {
  switch (setup.request) {
    case kModemStatus:
      bytes = {kModem, kLine};
      return 0;
    case kGetLatency:
      bytes = {static_cast<std::uint8_t>(kept_latency_ < 0 ? seen_.latency_ms : kept_latency_)};
      return 0;
    case kReadEeprom: {
      // Words 1 to 3 are vendor, product and release; the other words are not used here.
      const std::uint16_t words[] = {options_.eeprom_mode, 0x0403, 0x6014, 0x0900};
      const std::uint16_t word = options_.eeprom_mode == 0xFFFF ? std::uint16_t{0xFFFF}
                                 : setup.index < 4              ? words[setup.index]
                                                                : std::uint16_t{0};
      bytes = {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8)};
      return 0;
    }
    default:
      return -EPIPE;
  }
}

int VirtualFt232h::string_descriptor(const Setup& setup, std::vector<std::uint8_t>& bytes) const {
  const std::string texts[] = {identity_.manufacturer, options_.product, options_.serial_number};
  const std::size_t index = setup.value & 0xFF;
  if (index > 3) return -EPIPE;
  bytes = {0, 3};
  if (index == 0) {
    bytes.insert(bytes.end(), {0x09, 0x04});  // US English
  } else {
    for (const char letter : texts[index - 1]) {
      bytes.insert(bytes.end(), {static_cast<std::uint8_t>(letter), 0});
    }
  }
  bytes[0] = static_cast<std::uint8_t>(bytes.size());
  return 0;
}

}  // namespace fpga_stereo::sim
