// What a UsbfsDevice is while it is plugged in, to those who have its file open. For the files
// beside this one.
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

/// From plug() to the close of the last file: longer than the device is plugged in.
struct UsbfsDevice::Session {
  std::shared_ptr<Shared> shared;
  UsbfsDevice* device = nullptr;  // none once it is unplugged
  std::string node, syspath;
  _UMockdevIoctlBase* handler = nullptr;
  const void* claimed_by = nullptr;
  bool kernel_driver = false;
  std::deque<UrbPtr> control, in, out;
  std::deque<UrbPtr> done;  // to be reaped

  // poll() on the device's file says whether something can be reaped. The file is a FIFO that is
  // full or empty.
  int fifo = -1;
  bool ready = false;

  ~Session() { close(fifo); }
  void show_ready() {
    if (ready == !done.empty()) return;
    ready = !ready;
    std::array<char, 4096> page{};
    const auto done_bytes =
        ready ? read(fifo, page.data(), page.size()) : write(fifo, page.data(), page.size());
    if (done_bytes < 0 && errno != EAGAIN) throw std::runtime_error("the FIFO does not work");
  }

  std::deque<UrbPtr>& queue(std::uint8_t endpoint) {
    return endpoint == kIn ? in : endpoint == kOut ? out : control;
  }
  void finish(UrbPtr urb, int status) {  // often the front of a queue: not a reference
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
  /// The host does not want it any more.
  void discard(const UrbPtr& urb) {
    urb->discarded = true;
    if (!urb->busy) finish(urb, -ENOENT);
  }
  void vanished(const void* client);

  int submit(_UMockdevIoctlClient* client);
  int reap(_UMockdevIoctlClient* client);
  int discard_at(const void* client, std::uint64_t address);
  int claim(const void* client, bool disconnect);
  int release(const void* client);
  int driver_ioctl(_UMockdevIoctlClient* client);
  int answer(_UMockdevIoctlClient* client);
};

}  // namespace fpga_stereo::sim
