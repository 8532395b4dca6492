// A USB device without hardware, for programs that know nothing of it: umockdev carries what
// libusb asks of the kernel (sysfs, uevents, the ioctls of usbfs) to this class, in the same
// process or from another one. What the device does stands in a derived class.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

struct _UMockdevIoctlClient;
struct _UMockdevIoctlData;

namespace fpga_stereo::sim {

class UsbfsDevice {
 public:
  struct Identity {
    std::uint16_t vendor = 0, product = 0, release = 0;
    std::string manufacturer, product_name, serial_number;
    std::string port = "1-1";    // bus 1; the hubs on the way are made as well
    bool high_speed = true;      // bulk packets of 512 bytes, else 64
    bool kernel_driver = false;  // one is bound to the interface
  };

  /// Not plugged in.
  explicit UsbfsDevice(Identity identity);
  UsbfsDevice(const UsbfsDevice&) = delete;
  UsbfsDevice& operator=(const UsbfsDevice&) = delete;
  /// Unplugged by then: hooks are the derived class's.
  virtual ~UsbfsDevice();

  /// Each time with another device number, as from a kernel.
  void plug();
  /// Transfers under way end as with a device that is gone.
  void unplug();
  bool plugged() const;

  /// Whether within `timeout` nobody has the device open any more, unplugged ones included. A
  /// program in a system call of this device dies with this process: unplug, then wait, then end.
  bool wait_until_closed(std::chrono::milliseconds timeout) const;

  /// The errno that claiming the interface ends with; 0: none.
  void refuse_claims(int error);
  /// Whether others than root may open the device: as if no udev rule were installed.
  void permit(bool others);

  /// Where the tree of devices shall be, before the first one is made: an absolute path of nothing
  /// that exists. Without this it is somewhere in the folder for temporary files.
  static void place_devices(const std::string& folder);
  /// What another process needs in its environment ("NAME=VALUE") to see this process's devices. Of
  /// umockdev 0.17: the 50th failed open() of a file under /dev ends that process, and two
  /// processes that wait for devices to come and go may take each other's news.
  static std::vector<std::string> environment();

 protected:
  static constexpr std::uint8_t kIn = 0x81, kOut = 0x02;
  static constexpr int kHold = 1;  // control() does not answer

  struct Setup {
    std::uint8_t type, request;
    std::uint16_t value, index, length;
  };

  /// A transfer under way.
  struct Urb {
    std::uint8_t endpoint = 0;
    std::size_t size = 0;             // of the host's buffer
    std::vector<std::uint8_t> bytes;  // in: what the host gets; out: what it sent
    std::size_t taken = 0;            // out: bytes the device has taken
    bool busy = false;                // the device works on it without the lock
    bool discarded = false;           // by the host, while busy

    int status = 0;
    std::uint64_t address = 0;  // in the host's memory
    const void* client = nullptr;
    std::shared_ptr<_UMockdevIoctlData> data;
  };
  using UrbPtr = std::shared_ptr<Urb>;

  // The hooks; the lock is held.
  /// Answers with 0, with -EPIPE (not understood), or not at all: kHold.
  virtual int control(const Setup& setup, std::vector<std::uint8_t>& bytes) = 0;
  virtual void submitted() = 0;
  virtual void halt_cleared(std::uint8_t endpoint) = 0;
  virtual void reset() = 0;

  // For those who hold the lock.
  std::mutex& mutex() const;
  bool plugged_in() const { return session_ != nullptr; }
  /// Transfers under way, oldest first; empty if not plugged in.
  std::deque<UrbPtr>& urbs(std::uint8_t endpoint);
  /// Ends one: 0 or a negative errno. Does nothing if it has ended.
  void finish(const UrbPtr& urb, int status);

  const Identity identity_;

 private:
  struct Shared;
  struct Session;
  static int handle_ioctl(void*, _UMockdevIoctlClient* client, void* session);
  static void handle_connected(void*, _UMockdevIoctlClient* client, void* session);

  std::shared_ptr<Shared> shared_;
  std::shared_ptr<Session> session_;  // while plugged in
  std::deque<UrbPtr> none_;
  int number_ = 0;
  int claim_error_ = 0;
};

}  // namespace fpga_stereo::sim
