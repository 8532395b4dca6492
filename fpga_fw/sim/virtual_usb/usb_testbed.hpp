// The umockdev testbed of this process: the tree of USB devices that libusb sees instead of the
// real one.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "sim/virtual_usb/usbfs_device.hpp"

struct _UMockdevTestbed;
struct _UMockdevIoctlBase;

namespace fpga_stereo::sim {

class UsbTestbed {
 public:
  /// Returns the testbed, which the first call creates. It must precede the first use of libusb.
  static UsbTestbed& get();
  /// Moves the tree to `folder`, which must not exist, so that programs that start earlier know its
  /// place. To be called before the first device is added.
  void move_to(const std::string& folder);

  /// Creates the file of a device under the next free device number. Returns its path and, in
  /// `fifo`, the descriptor of the FIFO behind it, which the caller closes.
  std::string make_node(_UMockdevIoctlBase* handler, int& fifo);
  /// Shows a device and the hubs above it to libusb. Returns its path in sysfs.
  std::string add(const UsbfsDevice::Identity& identity, const std::string& node);
  void remove(const std::string& syspath, const std::string& node);

  /// Allows or forbids users other than root to open a device.
  void permit(const std::string& node, bool others);
  /// Returns the "NAME=VALUE" pairs with which another process sees these devices.
  std::vector<std::string> environment() const;

 private:
  UsbTestbed();
  ~UsbTestbed();
  void describe(const std::string& text);
  int next_number();
  void add_hub(const std::string& name, const std::string& path);

  std::mutex mutex_;
  _UMockdevTestbed* testbed_;
  std::string root_;
  bool moved_ = false;
  int last_number_ = 0;
  std::set<int> numbers_;                    // in use
  std::deque<std::string> retired_;          // files of removed devices, still handled
  std::map<std::string, std::string> hubs_;  // name, path
};

}  // namespace fpga_stereo::sim
