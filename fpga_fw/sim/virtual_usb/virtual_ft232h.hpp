// A virtual FT232H in synchronous 245 FIFO mode, which libusb finds like a real one. Sources:
// FTDI's data sheet, AN_108 and AN_130; the requests are those that libftdi and the kernel driver
// send. A FifoBackend, either a test or a virtual board, is on the FPGA's side of the FIFO.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "sim/virtual_usb/usbfs_device.hpp"

namespace fpga_stereo::sim {

/// The FPGA's side of the FIFO. The thread of the chip calls both functions.
class FifoBackend {
 public:
  virtual ~FifoBackend() = default;
  /// Takes bytes from the host. Returns how many it took; the chip offers the rest again after
  /// poke().
  virtual std::size_t receive(const std::uint8_t* bytes, std::size_t size) = 0;
  /// Writes up to `size` bytes for the host to `bytes`. Returns how many it wrote. After returning
  /// 0, call poke() when there are bytes.
  virtual std::size_t transmit(std::uint8_t* bytes, std::size_t size) = 0;
};

class VirtualFt232h : private UsbfsDevice {
 public:
  struct Options {
    std::string serial_number = "FS000001";
    std::string product = "fpga_stereo board";
    std::string port = "1-1";       // on bus 1
    bool high_speed = true;         // packets of 512 bytes, else 64
    bool kernel_driver = true;      // ftdi_sio is bound, as on most machines
    std::uint16_t eeprom_mode = 1;  // word 0: 1 is 245 FIFO, 0 UART, 0xFFFF a blank EEPROM
    /// Minimum period of the empty packets that the chip sends when its latency timer expires
    /// without data. A real chip sends them more often; this saves processor time.
    std::chrono::milliseconds idle_period{16};
  };

  /// Requests of the host since the device was plugged in.
  struct Seen {
    int latency_ms = 16;
    int bit_mode = 0;
    int resets = 0, purges = 0, halts_cleared = 0, usb_resets = 0;
    int flow_control = 0;         // 0x0100: RTS/CTS
    std::size_t max_pending = 0;  // transfers to the host in flight at the same time
    std::size_t urb_bytes = 0;    // size of the last transfer to the host
  };

  /// Creates the chip and plugs it in. The backend must outlive it.
  VirtualFt232h(FifoBackend& backend, Options options);
  ~VirtualFt232h() override;

  /// Tells the chip that the backend has bytes or room. Thread-safe, like all functions below.
  void poke();

  using UsbfsDevice::environment;
  using UsbfsDevice::is_plugged;
  using UsbfsDevice::permit;
  using UsbfsDevice::place_devices;
  using UsbfsDevice::refuse_claims;
  using UsbfsDevice::wait_until_closed;
  void plug();
  void unplug();
  Seen seen() const;

  // Faults.
  /// Stalls the next transfer to or from the host, and all others until the host clears the halt.
  void stall_in();
  void stall_out();
  /// Ends the next transfer to the host with this negative errno and without data.
  void fail_in(int error);
  /// Ends all transfers to the host with this negative errno; 0 stops.
  void fail_every_in(int error);
  /// Sets the overrun bit in the status of the next packet.
  void report_overrun();
  /// Limits the payload of packets, bytes; 0: to what they can hold.
  void limit_packets(std::size_t payload);
  /// Ends the next transfers to the host with 0 bytes, even without status.
  void send_empty(int num_transfers);
  /// Stalls this vendor request from now on.
  void fail_request(std::uint8_t request);
  /// Leaves all control requests unanswered while held.
  void hold_requests(bool is_held);
  /// Makes the latency timer read back as this, whatever the host sets.
  void keep_latency(int milliseconds);

 private:
  int control(const Setup& setup, std::vector<std::uint8_t>& bytes) override;
  void on_submitted() override;
  void on_halt_cleared(std::uint8_t endpoint) override;
  void on_reset() override;

  int vendor_out(const Setup& setup);
  int vendor_in(const Setup& setup, std::vector<std::uint8_t>& bytes) const;
  int string_descriptor(const Setup& setup, std::vector<std::uint8_t>& bytes) const;
  /// Stores a value with the lock held.
  template <class T>
  void set(T& member, T value);
  void wake();
  void clear_fifo();
  bool is_fifo_running() const { return seen_.bit_mode == 0x40 && options_.eeprom_mode == 1; }
  std::size_t packet_bytes() const { return options_.high_speed ? 512 : 64; }

  void run();
  std::chrono::milliseconds send_period(const Urb& urb) const;
  // Each returns whether it did something; `lock` is released while the backend is called.
  bool fetch(std::unique_lock<std::mutex>& lock);
  bool send();
  bool append_packet(Urb& urb, bool is_timer_expired);
  bool deliver(std::unique_lock<std::mutex>& lock);

  static constexpr std::uint8_t kModem = 0x32, kLine = 0x60;  // modem and line status

  FifoBackend& backend_;
  const Options options_;
  Seen seen_;
  std::condition_variable woken_;
  bool has_work_ = false, wants_stop_ = false;
  bool is_in_halted_ = false, is_out_halted_ = false;
  std::vector<std::uint8_t> fifo_;  // from the backend, not yet in a packet
  std::size_t fifo_read_ = 0;       // bytes of fifo_ that are in packets
  std::chrono::steady_clock::time_point last_sent_{};
  int next_error_ = 0, every_error_ = 0;  // 0: none
  int num_empty_ = 0;                     // transfers to end without data
  int kept_latency_ = -1;                 // ms; -1: as the host sets it
  bool has_overrun_ = false, are_requests_held_ = false;
  std::size_t payload_limit_ = 0;
  std::set<std::uint8_t> failing_requests_;
  std::thread thread_;
};

}  // namespace fpga_stereo::sim
