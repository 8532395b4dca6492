// A USB device without hardware, usable by unmodified programs: umockdev passes libusb's system
// calls (sysfs, uevents, usbfs ioctls) to this class, from this process or another one. A derived
// class defines the behaviour of the device.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "sim/ft232h/usb_types.hpp"

struct _UMockdevIoctlClient;
struct _UMockdevIoctlData;

namespace fpga_stereo::sim {

class UsbfsDevice {
 public:
  struct Identity : UsbIdentity {
    std::string port = "1-1";    // on bus 1; hubs on the path are created
    bool high_speed = true;      // bulk packets of 512 bytes, else 64
    bool kernel_driver = false;  // ftdi_sio is bound to the interface
  };

  /// Creates an unplugged device.
  explicit UsbfsDevice(Identity identity);
  UsbfsDevice(const UsbfsDevice&) = delete;
  UsbfsDevice& operator=(const UsbfsDevice&) = delete;
  /// The derived class must have unplugged it, because unplugging calls the hooks.
  virtual ~UsbfsDevice();

  /// Plugs the device in, under a new device number.
  void plug();
  /// Unplugs the device; transfers in flight fail with ESHUTDOWN.
  void unplug();
  bool is_plugged() const;

  /// Blocks until no program has the device open, also after it was unplugged. Returns false on
  /// timeout. If this process ends while a program is in a system call of this device, that program
  /// dies: unplug, wait, then end.
  bool wait_until_closed(std::chrono::milliseconds timeout) const;

  /// Makes claims of the interface fail with this errno; 0 allows them.
  void refuse_claims(int error);
  /// Makes attempts to clear a halt fail with this errno; 0 allows them.
  void refuse_clearing(int error);
  /// Allows or forbids users other than root to open the device, as with or without a udev rule.
  void permit(bool others);

  /// Sets the folder of the device tree, an absolute path that does not exist. To be called before
  /// the first device is created. The default is a new folder for temporary files.
  static void place_devices(const std::string& folder);
  /// Returns the environment ("NAME=VALUE") with which another process sees the devices of this
  /// one. Limits of umockdev 0.17: the 50th failed open() of a file under /dev ends that process,
  /// and two processes that wait for hotplug events may receive each other's events.
  static std::vector<std::string> environment();

 protected:
  static constexpr std::uint8_t kIn = 0x81, kOut = 0x02;
  static constexpr int kHold = 1;  // result of control(): no answer

  /// A transfer in flight.
  struct Urb {
    std::uint8_t endpoint = 0;
    std::size_t size = 0;             // of the host's buffer
    std::vector<std::uint8_t> bytes;  // in: for the host; out: from the host
    std::size_t taken = 0;            // out: bytes that the device has taken
    bool is_busy = false;             // the device uses it without holding the lock
    bool is_discarded = false;        // by the host, while it is busy

    int status = 0;
    std::uint64_t address = 0;  // in the host's memory
    const void* client = nullptr;
    std::shared_ptr<_UMockdevIoctlData> data;
  };
  using UrbPtr = std::shared_ptr<Urb>;

  // Hooks, called with the lock held.
  /// Handles a control transfer. Returns 0, -EPIPE to stall it, or kHold to leave it unanswered.
  virtual int control(const UsbSetup& setup, std::vector<std::uint8_t>& bytes) = 0;
  /// A bulk transfer was submitted.
  virtual void on_submitted() = 0;
  /// The host cleared the halt of an endpoint.
  virtual void on_halt_cleared(std::uint8_t endpoint) = 0;
  /// The host reset the device.
  virtual void on_reset() = 0;

  std::mutex& mutex() const;
  // The caller of these holds the lock.
  bool plugged_in() const { return session_ != nullptr; }
  /// Returns the transfers in flight, oldest first; empty while unplugged.
  std::deque<UrbPtr>& urbs(std::uint8_t endpoint);
  /// Ends a transfer with 0 or a negative errno, unless it has ended already.
  void finish(const UrbPtr& urb, int status);

  const Identity identity_;

 private:
  struct Shared;
  struct Session;
  static int handle_ioctl(void*, _UMockdevIoctlClient* client, void* session);
  static void handle_connected(void*, _UMockdevIoctlClient* client, void* session);

  std::shared_ptr<Shared> shared_;
  std::shared_ptr<Session> session_;  // while plugged in
  std::deque<UrbPtr> no_urbs_;
  int number_ = 0;
  int claim_error_ = 0, clear_error_ = 0;
};

}  // namespace fpga_stereo::sim
