// The procedure follows FTDI's AN_130 (synchronous 245 FIFO) and AN_232B-04 (latency timer, status
// bytes); the request numbers are those of libftdi and of the kernel's ftdi_sio.
#include "link/ftdi.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "link/usb_device.hpp"

namespace fpga_stereo::link {
namespace {

constexpr std::uint8_t kReset = 0x00, kSetFlowControl = 0x02, kSetLatency = 0x09;
constexpr std::uint8_t kGetLatency = 0x0A, kSetBitMode = 0x0B;
constexpr std::uint16_t kResetAll = 0, kPurgeOne = 1, kPurgeOther = 2;
constexpr std::uint16_t kModeReset = 0x00FF, kModeSyncFifo = 0x40FF;  // all pins
constexpr std::uint16_t kRtsCts = 0x0100;

constexpr std::size_t kStatusBytes = 2;
constexpr std::uint8_t kLineOverrun = 0x02;

constexpr std::uint16_t kEepromModes = 0x000F, kEepromFifo = 0x0001, kEepromBlank = 0xFFFF;

}  // namespace

Stripped strip_status(std::uint8_t* bytes, std::size_t size, std::size_t packet) {
  Stripped stripped;
  for (std::size_t at = 0; at + kStatusBytes <= size; at += packet) {
    if ((bytes[at + 1] & kLineOverrun) != 0) ++stripped.overruns;
    const std::size_t payload = std::min(packet, size - at) - kStatusBytes;
    std::memmove(bytes + stripped.size, bytes + at + kStatusBytes, payload);
    stripped.size += payload;
  }
  return stripped;
}

Status check_fifo_mode(std::uint16_t eeprom_word, const std::string& device) {
  if (eeprom_word != kEepromBlank && (eeprom_word & kEepromModes) == kEepromFifo) return {};
  const std::string state = eeprom_word == kEepromBlank
                                ? "has a blank EEPROM, which makes its chip a UART"
                                : "is not set to 245 FIFO mode in its EEPROM (channel A: mode " +
                                      std::to_string(eeprom_word & kEepromModes) + ", needed: 1)";
  return Error{ErrorKind::kIo,
               device + " " + state +
                   ": set channel A to 245 FIFO with FTDI's FT_Prog, or with ftdi_eeprom "
                   "(cha_type=FIFO), then plug it in again"};
}

Status purge_ftdi(const UsbDevice& device) {
  for (const auto side : {kPurgeOne, kPurgeOther}) {
    if (Status sent = device.send(kReset, side); !sent) return sent;
  }
  return {};
}

Status set_up_ftdi(const UsbDevice& device, int latency_ms) {
  std::uint8_t word[2] = {};
  if (Status got = device.receive(kReadEeprom, 0, word, 2); !got) return got;
  const auto mode = static_cast<std::uint16_t>(word[0] | word[1] << 8);
  if (Status fifo = check_fifo_mode(mode, device.name); !fifo) return fifo;

  if (Status sent = device.send(kReset, kResetAll); !sent) return sent;
  if (Status sent = device.send(kSetBitMode, kModeReset); !sent) return sent;
  // The chip's clock stops and starts with its mode; AN_130 waits here.
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  if (Status sent = device.send(kSetLatency, static_cast<std::uint16_t>(latency_ms)); !sent) {
    return sent;
  }
  std::uint8_t latency = 0;
  if (Status got = device.receive(kGetLatency, 0, &latency, 1); !got) return got;
  if (latency != latency_ms) {
    return Error{ErrorKind::kIo,
                 fmt::format("{}: the latency timer was set to {} ms and reads back as {} ms",
                             device.name, latency_ms, latency)};
  }
  if (Status sent = device.send(kSetBitMode, kModeSyncFifo); !sent) return sent;
  if (Status sent = device.send(kSetFlowControl, 0, kRtsCts); !sent) return sent;
  return purge_ftdi(device);
}

}  // namespace fpga_stereo::link
