// An FT232H in synchronous 245 FIFO mode: its identity, its vendor requests, and the packets that
// it makes of the bytes in its FIFO. It knows nothing of the USB connection that carries them.
// Sources: FTDI's data sheet, AN_108 and AN_130; the requests are those that libftdi and the
// kernel's ftdi_sio send.
#pragma once

#include <chrono>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "sim/ft232h/usb_types.hpp"

namespace fpga_stereo::sim {

/// Not thread-safe.
class Ft232h {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::uint8_t kIn = 0x81, kOut = 0x02;  // bulk endpoints
  static constexpr std::size_t kHighSpeedPacket = 512, kFullSpeedPacket = 64;
  static constexpr int kMaxPower = 100;  // mA

  struct Options {
    std::string serial_number = "FS000001";
    std::string product = "fpga_stereo board";
    bool high_speed = true;         // packets of 512 bytes, else 64
    std::uint16_t eeprom_mode = 1;  // word 0: 1 is 245 FIFO, 0 UART, 0xFFFF a blank EEPROM
    /// Minimum period of the empty packets that the chip sends when its latency timer expires
    /// without data. A real chip sends them more often; this saves processor time.
    std::chrono::milliseconds idle_period{16};
  };

  /// Requests of the host since the chip was powered on.
  struct Seen {
    int latency_ms = 16;
    int bit_mode = 0;
    int resets = 0, purges = 0, usb_resets = 0;
    int flow_control = 0;  // 0x0100: RTS/CTS
  };

  explicit Ft232h(Options options);

  UsbIdentity identity() const;
  const Seen& seen() const { return seen_; }

  /// Returns to the state after plugging in.
  void power_on();
  /// The host reset the device.
  void usb_reset();

  /// Handles a vendor request. `answer` receives the bytes for the host. Returns false to stall it.
  bool handle(const UsbSetup& setup, std::vector<std::uint8_t>& answer);
  /// Returns whether the request empties the FIFO.
  static bool empties_fifo(const UsbSetup& setup);

  /// Returns whether the FIFO is connected to the pins, so that the backend may use it.
  bool is_running() const { return seen_.bit_mode == 0x40 && options_.eeprom_mode == 1; }
  /// Returns how many bytes the FIFO takes until it holds `size`.
  std::size_t room(std::size_t size) const;
  /// Adds bytes for the host to the FIFO; discards them unless it is running.
  void push(const std::vector<std::uint8_t>& bytes);

  std::size_t packet_bytes() const { return packet_bytes_; }
  void set_packet_bytes(std::size_t size) { packet_bytes_ = size; }
  /// Returns when the chip sends a packet that is not full.
  Clock::time_point timer_end() const;
  /// Appends the next packet, which begins with two status bytes, if it is full or the timer has
  /// expired. A packet that is not full ends its transfer.
  bool append_packet(std::vector<std::uint8_t>& transfer);

  // Faults.
  /// Sets the overrun bit in the status of the next packet.
  void report_overrun() { has_overrun_ = true; }
  /// Limits the payload of packets, bytes; 0: to what they can hold.
  void limit_packets(std::size_t payload) { payload_limit_ = payload; }
  /// Stalls this vendor request from now on.
  void fail_request(std::uint8_t request) { failing_requests_.insert(request); }
  /// Makes the latency timer read back as this, whatever the host sets.
  void keep_latency(int milliseconds) { kept_latency_ = milliseconds; }

 private:
  bool handle_out(const UsbSetup& setup);
  bool handle_in(const UsbSetup& setup, std::vector<std::uint8_t>& answer) const;
  void clear_fifo();

  const Options options_;
  Seen seen_;
  std::size_t packet_bytes_;
  std::vector<std::uint8_t> fifo_;  // for the host, not yet in a packet
  std::size_t fifo_read_ = 0;       // bytes of fifo_ that are in packets
  bool is_transfer_open_ = false;   // the last packet was full
  Clock::time_point last_sent_{};
  bool has_overrun_ = false;
  std::size_t payload_limit_ = 0;
  int kept_latency_ = -1;  // ms; -1: as the host sets it
  std::set<std::uint8_t> failing_requests_;
};

}  // namespace fpga_stereo::sim
