#include "sim/ft232h/ft232h.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::sim {
namespace {

constexpr std::uint8_t kReset = 0x00, kFlowControl = 0x02, kBaudRate = 0x03, kModemStatus = 0x05;
constexpr std::uint8_t kSetLatency = 0x09, kGetLatency = 0x0A, kBitMode = 0x0B, kReadEeprom = 0x90;

// Each packet begins with modem status and line status.
constexpr std::uint8_t kModem = 0x32, kLine = 0x60;
constexpr std::uint8_t kOverrun = 0x02;  // bit of the line status
constexpr std::size_t kStatusBytes = 2;

}  // namespace

Ft232h::Ft232h(Options options)
    : options_(std::move(options)),
      packet_bytes_(options_.high_speed ? kHighSpeedPacket : kFullSpeedPacket) {}

UsbIdentity Ft232h::identity() const {
  UsbIdentity identity;
  identity.vendor = 0x0403;
  identity.product = 0x6014;
  identity.release = 0x0900;
  identity.manufacturer = "fpga_stereo";
  identity.product_name = options_.product;
  identity.serial_number = options_.serial_number;
  return identity;
}

void Ft232h::power_on() {
  seen_ = {};
  clear_fifo();
}

void Ft232h::usb_reset() {
  ++seen_.usb_resets;
  seen_.bit_mode = 0;
  clear_fifo();
}

bool Ft232h::handle(const UsbSetup& setup, std::vector<std::uint8_t>& answer) {
  if (failing_requests_.count(setup.request) > 0) return false;
  if (setup.type == 0x40) return handle_out(setup);
  if (setup.type == 0xC0) return handle_in(setup, answer);
  return false;
}

bool Ft232h::empties_fifo(const UsbSetup& setup) {
  return setup.type == 0x40 && setup.request == kReset;
}

bool Ft232h::handle_out(const UsbSetup& setup) {
  switch (setup.request) {
    case kReset:
      if (setup.value == 0) {
        ++seen_.resets;
      } else {
        ++seen_.purges;
      }
      clear_fifo();
      return true;
    case kFlowControl:
      seen_.flow_control = setup.index & 0xFF00;
      return true;
    case kBaudRate:
      return true;
    case kSetLatency:
      if (setup.value < 1 || setup.value > 255) return false;
      seen_.latency_ms = setup.value;
      return true;
    case kBitMode:
      seen_.bit_mode = setup.value >> 8;
      return true;
    default:
      return false;
  }
}

bool Ft232h::handle_in(const UsbSetup& setup, std::vector<std::uint8_t>& answer) const {
  switch (setup.request) {
    case kModemStatus:
      answer = {kModem, kLine};
      return true;
    case kGetLatency:
      answer = {static_cast<std::uint8_t>(kept_latency_ < 0 ? seen_.latency_ms : kept_latency_)};
      return true;
    case kReadEeprom: {
      // Words 1 to 3 are vendor, product and release; the other words are not used here.
      const std::uint16_t words[] = {options_.eeprom_mode, 0x0403, 0x6014, 0x0900};
      const std::uint16_t word = options_.eeprom_mode == 0xFFFF ? std::uint16_t{0xFFFF}
                                 : setup.index < 4              ? words[setup.index]
                                                                : std::uint16_t{0};
      answer = {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8)};
      return true;
    }
    default:
      return false;
  }
}

void Ft232h::clear_fifo() {
  fifo_.clear();
  fifo_read_ = 0;
}

std::size_t Ft232h::room(std::size_t size) const {
  return size - std::min(size, fifo_.size() - fifo_read_);
}

void Ft232h::push(const std::vector<std::uint8_t>& bytes) {
  if (!is_running()) return;
  fifo_.erase(fifo_.begin(), fifo_.begin() + static_cast<std::ptrdiff_t>(fifo_read_));
  fifo_read_ = 0;
  fifo_.insert(fifo_.end(), bytes.begin(), bytes.end());
}

Ft232h::Clock::time_point Ft232h::timer_end() const {
  const std::chrono::milliseconds latency(seen_.latency_ms);
  const bool has_data = fifo_read_ < fifo_.size() || is_transfer_open_;
  return last_sent_ + (has_data ? latency : std::max(latency, options_.idle_period));
}

bool Ft232h::append_packet(std::vector<std::uint8_t>& transfer) {
  const auto now = Clock::now();
  const std::size_t capacity = packet_bytes_ - kStatusBytes;
  const std::size_t limit = payload_limit_ > 0 ? std::min(payload_limit_, capacity) : capacity;
  const std::size_t payload = std::min(limit, fifo_.size() - fifo_read_);
  if (payload < limit && now < timer_end()) return false;
  const auto overrun = std::exchange(has_overrun_, false) ? kOverrun : std::uint8_t{0};
  transfer.push_back(kModem);
  transfer.push_back(kLine | overrun);
  const auto begin = fifo_.begin() + static_cast<std::ptrdiff_t>(fifo_read_);
  transfer.insert(transfer.end(), begin, begin + static_cast<std::ptrdiff_t>(payload));
  fifo_read_ += payload;
  is_transfer_open_ = payload == capacity;
  last_sent_ = now;
  return true;
}

}  // namespace fpga_stereo::sim
