// An FT232H in synchronous 245 FIFO mode that libusb finds like a real one (AN_108, AN_130 and the
// chip's data sheet of FTDI; requests as libftdi's and the kernel's drivers send them). What stands
// behind its FIFO is a FifoBackend: a test, or a whole board.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "sim/virtual_usb/usbfs_device.hpp"

namespace fpga_stereo::sim {

/// The FPGA's side of the FIFO. Both are called by the chip's thread.
class FifoBackend {
 public:
  virtual ~FifoBackend() = default;
  /// Bytes from the host: how many were taken. The rest is offered again after poke().
  virtual std::size_t receive(const std::uint8_t* bytes, std::size_t size) = 0;
  /// Bytes for the host, up to `size`; 0: none yet, call poke() when there are.
  virtual std::size_t transmit(std::uint8_t* bytes, std::size_t size) = 0;
};

class VirtualFt232h : private UsbfsDevice {
 public:
  struct Options {
    std::string serial_number = "FS000001";
    std::string product = "fpga_stereo board";
    std::string port = "1-1";       // bus 1
    bool high_speed = true;         // packets of 512 bytes, else 64
    bool kernel_driver = true;      // ftdi_sio is bound, as on most machines
    std::uint16_t eeprom_mode = 1;  // word 0: 1 is 245 FIFO, 0 UART, 0xFFFF a blank EEPROM
    /// A chip without data sends an empty packet whenever its latency timer expires. Here not more
    /// often than this, to spare the processor.
    std::chrono::milliseconds idle_period{16};
  };

  /// What the host has done.
  struct Seen {
    int latency_ms = 16;
    int bit_mode = 0;
    int resets = 0, purges = 0, halts_cleared = 0, usb_resets = 0;
    int flow_control = 0;          // 0x0100: RTS/CTS
    std::size_t most_pending = 0;  // transfers for data to the host, at once
    std::size_t urb_bytes = 0;     // of the last one of them
  };

  /// Plugs it in. The backend outlives it.
  VirtualFt232h(FifoBackend& backend, Options options);
  ~VirtualFt232h() override;

  /// The backend has bytes, or room.
  void poke();

  using UsbfsDevice::environment;
  using UsbfsDevice::permit;
  using UsbfsDevice::place_devices;
  using UsbfsDevice::plugged;
  using UsbfsDevice::refuse_claims;
  using UsbfsDevice::wait_until_closed;
  void plug();
  void unplug();
  Seen seen() const;

  // What goes wrong.
  void stall_in();   // the next transfer to the host, and all until the halt is cleared
  void stall_out();  // the same from the host
  /// The next transfer to the host ends with this (negative) errno and without data.
  void fail_in(int error);
  void fail_every_in(int error);            // and all others; 0: no more
  void report_overrun();                    // in the next packet
  void limit_packets(std::size_t payload);  // to fewer bytes than they can hold; 0: none
  void send_empty(int transfers);           // the next ones end with 0 bytes, without status
  void fail_request(std::uint8_t request);  // it stalls, from now on
  void hold_requests(bool hold);            // none is answered
  void keep_latency(int milliseconds);      // whatever is set, this is read back

 private:
  int control(const Setup& setup, std::vector<std::uint8_t>& bytes) override;
  void submitted() override;
  void halt_cleared(std::uint8_t endpoint) override;
  void reset() override;

  int vendor_out(const Setup& setup);
  int vendor_in(const Setup& setup, std::vector<std::uint8_t>& bytes) const;
  int string_descriptor(const Setup& setup, std::vector<std::uint8_t>& bytes) const;
  void forget();
  bool fifo_runs() const { return seen_.bit_mode == 0x40 && options_.eeprom_mode == 1; }
  std::size_t packet_bytes() const { return options_.high_speed ? 512 : 64; }

  void run();
  bool fetch(std::unique_lock<std::mutex>& lock);
  bool send();
  bool append_packet(Urb& urb, bool timer);
  bool take(std::unique_lock<std::mutex>& lock);

  FifoBackend& backend_;
  const Options options_;
  Seen seen_;
  std::condition_variable wake_;
  bool poked_ = false, stop_ = false;
  bool in_halted_ = false, out_halted_ = false;
  std::vector<std::uint8_t> staged_;  // of the backend, not yet in a packet
  std::size_t staged_at_ = 0;
  std::chrono::steady_clock::time_point last_sent_{};
  int next_error_ = 0, every_error_ = 0, empty_ = 0, kept_latency_ = -1;
  bool overrun_ = false, hold_ = false;
  std::size_t payload_limit_ = 0;
  std::map<std::uint8_t, bool> failing_;  // requests
  std::thread thread_;
};

}  // namespace fpga_stereo::sim
