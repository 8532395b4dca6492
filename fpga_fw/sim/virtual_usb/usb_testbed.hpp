// The one umockdev testbed of this process: the tree of USB devices that libusb sees in place of
// the real one.
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
  /// Made by the first call, before the first use of libusb; lasts as long as the process.
  static UsbTestbed& get();
  /// Moves it to `folder`, which must not exist: programs that start before this one can be told
  /// where it will be. Before the first device.
  void move_to(const std::string& folder);

  /// A device's file, under the next free number, and the FIFO behind it.
  std::string make_node(_UMockdevIoctlBase* handler, int& fifo);
  /// Shows a device (and the hubs above it) to libusb; its path in sysfs.
  std::string add(const UsbfsDevice::Identity& identity, const std::string& node);
  void remove(const std::string& syspath, const std::string& node);

  void permit(const std::string& node, bool others);
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
  std::deque<std::string> retired_;          // files of devices that are gone, still answered for
  std::map<std::string, std::string> hubs_;  // name, path
};

}  // namespace fpga_stereo::sim
