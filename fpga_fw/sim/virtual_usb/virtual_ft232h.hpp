// A virtual FT232H that libusb finds like a real one: the chip on virtual USB. A FifoBackend,
// either a test or a virtual board, is on the FPGA's side of the FIFO.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "sim/ft232h/fifo_backend.hpp"
#include "sim/ft232h/ft232h.hpp"
#include "sim/virtual_usb/usbfs_device.hpp"

namespace fpga_stereo::sim {

class VirtualFt232h : private UsbfsDevice {
 public:
  struct Options : Ft232h::Options {
    std::string port = "1-1";   // on bus 1
    bool kernel_driver = true;  // ftdi_sio is bound, as on most machines
  };

  /// Requests and transfers of the host since the device was plugged in.
  struct Seen : Ft232h::Seen {
    int halts_cleared = 0;
    std::size_t max_pending = 0;  // transfers to the host in flight at the same time
    std::size_t urb_bytes = 0;    // size of the last transfer to the host
  };

  /// Creates the chip and plugs it in. The backend must outlive it.
  VirtualFt232h(FifoBackend& backend, const Options& options);
  ~VirtualFt232h() override;

  /// Tells the chip that the backend has bytes or room. Thread-safe, like all functions below.
  void poke();

  using UsbfsDevice::environment;
  using UsbfsDevice::is_plugged;
  using UsbfsDevice::permit;
  using UsbfsDevice::place_devices;
  using UsbfsDevice::refuse_claims;
  using UsbfsDevice::refuse_clearing;
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
  int control(const UsbSetup& setup, std::vector<std::uint8_t>& bytes) override;
  void on_submitted() override;
  void on_halt_cleared(std::uint8_t endpoint) override;
  void on_reset() override;

  int string_descriptor(const UsbSetup& setup, std::vector<std::uint8_t>& bytes) const;
  /// Calls `change` with the lock held, then wakes the thread.
  template <class Change>
  void apply(const Change& change);
  void wake();

  void run();
  // Each returns whether it did something; `lock` is released while the backend is called.
  bool fetch(std::unique_lock<std::mutex>& lock);
  bool send();
  bool deliver(std::unique_lock<std::mutex>& lock);

  FifoBackend& backend_;
  Ft232h chip_;
  Seen seen_;  // except for what chip_ has seen
  std::condition_variable woken_;
  bool has_work_ = false, wants_stop_ = false;
  bool is_in_halted_ = false, is_out_halted_ = false;
  int next_error_ = 0, every_error_ = 0;  // 0: none
  int num_empty_ = 0;                     // transfers to end without data
  bool are_requests_held_ = false;
  std::thread thread_;
};

}  // namespace fpga_stereo::sim
