// The state of a UsbfsDevice while it is plugged in or its file is open. Internal to this folder.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/virtual_usb/usbfs_device.hpp"

struct _UMockdevIoctlBase;

namespace fpga_stereo::sim {

struct UsbfsDevice::Shared {
  std::mutex mutex;
  std::condition_variable closed;
  int clients = 0;  // open files
};

/// Lives from plug() until the last client has closed the file, which may be after unplug().
struct UsbfsDevice::Session {
  std::shared_ptr<Shared> shared;
  UsbfsDevice* device = nullptr;  // null after unplug()
  std::string node, syspath;
  _UMockdevIoctlBase* handler = nullptr;
  const void* claimed_by = nullptr;
  bool kernel_driver = false;
  std::deque<UrbPtr> control, in, out;
  std::deque<UrbPtr> done;  // ended, not yet reaped

  // A client calls poll() on the device file to learn whether a transfer can be reaped. The file is
  // a FIFO: full if not, empty if one can.
  int fifo = -1;
  bool is_ready = false;

  ~Session() { close(fifo); }
  void show_ready() {
    if (is_ready == !done.empty()) return;
    is_ready = !is_ready;
    std::array<char, 4096> page{};
    const auto done_bytes =
        is_ready ? read(fifo, page.data(), page.size()) : write(fifo, page.data(), page.size());
    if (done_bytes < 0 && errno != EAGAIN)
      throw std::runtime_error("cannot fill or empty the FIFO of a virtual USB device");
  }

  std::deque<UrbPtr>& queue(std::uint8_t endpoint) {
    return endpoint == kIn ? in : endpoint == kOut ? out : control;
  }
  void finish(UrbPtr urb, int status) {  // by value, because it is erased from a queue
    auto& urbs = queue(urb->endpoint);
    const auto found = std::find(urbs.begin(), urbs.end(), urb);
    if (found == urbs.end()) return;
    urbs.erase(found);
    urb->status = status;
    done.push_back(std::move(urb));
    show_ready();
  }
  void finish_all(int status) {
    for (auto* urbs : {&control, &in, &out}) {
      while (!urbs->empty()) finish(urbs->front(), status);
    }
  }
  /// The host cancels a transfer.
  void discard(const UrbPtr& urb) {
    urb->is_discarded = true;
    if (!urb->is_busy) finish(urb, -ENOENT);
  }
  void remove_client(const void* client);

  int submit(_UMockdevIoctlClient* client);
  int reap(_UMockdevIoctlClient* client);
  int discard_at(const void* client, std::uint64_t address);
  int claim(const void* client, bool disconnect);
  int release(const void* client);
  int driver_ioctl(_UMockdevIoctlClient* client);
  int answer(_UMockdevIoctlClient* client);
};

}  // namespace fpga_stereo::sim
