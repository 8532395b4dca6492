// The usbfs ioctls that libusb uses, with the semantics of the kernel's drivers/usb/core/devio.c.
#include "sim/virtual_usb/usbfs_session.hpp"

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <cstring>

namespace fpga_stereo::sim {
namespace {

using Data = std::shared_ptr<UMockdevIoctlData>;

/// Maps the memory that the pointer at `offset` points to in the client's process. Valid while the
/// client waits for the answer.
Data resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t size) {
  return {umockdev_ioctl_data_resolve(data, offset, size, nullptr), [](UMockdevIoctlData* child) {
            if (child != nullptr) g_object_unref(child);
          }};
}

template <class T>
T* as(const Data& data) {
  return reinterpret_cast<T*>(data->data);
}

}  // namespace

void UsbfsDevice::Session::remove_client(const void* client) {
  const std::lock_guard lock(shared->mutex);
  --shared->clients;
  shared->closed.notify_all();
  if (claimed_by == client) claimed_by = nullptr;
  for (auto* urbs : {&control, &in, &out, &done}) {
    urbs->erase(std::remove_if(urbs->begin(), urbs->end(),
                               [&](const UrbPtr& urb) { return urb->client == client; }),
                urbs->end());
  }
  show_ready();
}

int UsbfsDevice::Session::submit(UMockdevIoctlClient* client) {
  if (device == nullptr) return -ENODEV;
  const auto urb = std::make_shared<Urb>();
  auto* arg = umockdev_ioctl_client_get_arg(client);
  std::memcpy(&urb->address, arg->data, sizeof(urb->address));
  urb->data = resolve(arg, 0, sizeof(usbdevfs_urb));
  urb->client = client;
  if (!urb->data) return -EFAULT;
  auto* raw = as<usbdevfs_urb>(urb->data);
  urb->endpoint = raw->endpoint;
  urb->size = static_cast<std::size_t>(raw->buffer_length);
  const bool is_control = raw->type == USBDEVFS_URB_TYPE_CONTROL;
  if (!is_control && urb->endpoint != kIn && urb->endpoint != kOut) return -ENOENT;
  if (!is_control && claimed_by != client) return -EINVAL;
  if (urb->endpoint != kIn && urb->size > 0) {
    const auto buffer = resolve(urb->data.get(), offsetof(usbdevfs_urb, buffer), urb->size);
    if (!buffer) return -EFAULT;
    urb->bytes.assign(buffer->data, buffer->data + urb->size);
  }
  queue(urb->endpoint).push_back(urb);
  if (!is_control) {
    device->on_submitted();
    return 0;
  }
  if (urb->size < 8) return -EINVAL;
  const auto& bytes = urb->bytes;
  const auto u16 = [&](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  const UsbSetup setup{bytes[0], bytes[1], u16(2), u16(4), u16(6)};
  std::vector<std::uint8_t> contents(bytes.begin() + 8, bytes.end());
  const bool in_data = setup.is_in();
  if (in_data) contents.clear();
  const int status = device->control(setup, contents);
  if (in_data && contents.size() > setup.length) contents.resize(setup.length);
  urb->taken = in_data ? contents.size() : setup.length;
  urb->bytes = in_data ? contents : std::vector<std::uint8_t>{};
  if (status != kHold) finish(urb, status);
  return 0;
}

int UsbfsDevice::Session::reap(UMockdevIoctlClient* client) {
  const auto found = std::find_if(done.begin(), done.end(),
                                  [&](const UrbPtr& urb) { return urb->client == client; });
  if (found == done.end()) return device == nullptr ? -ENODEV : -EAGAIN;
  const UrbPtr urb = *found;
  const auto slot = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(void*));
  if (!slot) return -EFAULT;
  auto* raw = as<usbdevfs_urb>(urb->data);
  const bool is_in = urb->endpoint == kIn;
  raw->status = urb->status;
  raw->actual_length = static_cast<int>(is_in ? urb->bytes.size() : urb->taken);
  const std::size_t skip = is_in ? 0 : 8;  // the setup packet of a control transfer
  if (urb->endpoint != kOut && !urb->bytes.empty()) {
    const auto buffer =
        resolve(urb->data.get(), offsetof(usbdevfs_urb, buffer), urb->bytes.size() + skip);
    if (!buffer) return -EFAULT;
    std::memcpy(buffer->data + skip, urb->bytes.data(), urb->bytes.size());
  }
  umockdev_ioctl_data_set_ptr(slot.get(), 0, urb->data.get());
  done.erase(found);
  show_ready();
  return 0;
}

int UsbfsDevice::Session::discard_at(const void* client, std::uint64_t address) {
  for (auto* urbs : {&control, &in, &out}) {
    for (const auto& urb : *urbs) {
      if (urb->client != client || urb->address != address || urb->is_discarded) continue;
      discard(UrbPtr(urb));
      return 0;
    }
  }
  return -EINVAL;
}

int UsbfsDevice::Session::claim(const void* client, bool disconnect) {
  if (device->claim_error_ != 0) return -device->claim_error_;
  if (kernel_driver && !disconnect) return -EBUSY;
  if (claimed_by != nullptr && claimed_by != client) return -EBUSY;
  kernel_driver = false;
  claimed_by = client;
  return 0;
}

int UsbfsDevice::Session::release(const void* client) {
  if (claimed_by != client) return -EINVAL;
  claimed_by = nullptr;
  for (auto* urbs : {&in, &out}) {
    for (const auto& urb : std::deque<UrbPtr>(*urbs)) discard(urb);
  }
  return 0;
}

int UsbfsDevice::Session::driver_ioctl(UMockdevIoctlClient* client) {
  const auto command = resolve(umockdev_ioctl_client_get_arg(client), 0, sizeof(usbdevfs_ioctl));
  if (!command) return -EFAULT;
  const auto code = static_cast<unsigned>(as<usbdevfs_ioctl>(command)->ioctl_code);
  if (code == USBDEVFS_CONNECT) {
    kernel_driver = device->identity_.kernel_driver;
    return kernel_driver ? 1 : 0;
  }
  if (code != USBDEVFS_DISCONNECT) return -ENOTTY;
  if (!kernel_driver) return -ENODATA;
  kernel_driver = false;
  return 0;
}

int UsbfsDevice::Session::answer(UMockdevIoctlClient* client) {
  const auto request = static_cast<unsigned>(umockdev_ioctl_client_get_request(client));
  auto* arg = umockdev_ioctl_client_get_arg(client);
  const std::lock_guard lock(shared->mutex);
  if (request == USBDEVFS_REAPURBNDELAY || request == USBDEVFS_REAPURB) return reap(client);
  if (device == nullptr) return -ENODEV;
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      const auto capabilities = resolve(arg, 0, sizeof(std::uint32_t));
      if (!capabilities) return -EFAULT;
      // Like xHCI and EHCI: libusb then uses one URB per transfer, whatever its size.
      *as<std::uint32_t>(capabilities) =
          USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
          USBDEVFS_CAP_BULK_SCATTER_GATHER | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return 0;
    }
    case USBDEVFS_CLAIMINTERFACE:
      return claim(client, false);
    case USBDEVFS_DISCONNECT_CLAIM:
      return claim(client, true);
    case USBDEVFS_RELEASEINTERFACE:
      return release(client);
    case USBDEVFS_GETDRIVER: {
      const auto driver = resolve(arg, 0, sizeof(usbdevfs_getdriver));
      if (!driver) return -EFAULT;
      if (!kernel_driver && claimed_by == nullptr) return -ENODATA;
      auto& name = as<usbdevfs_getdriver>(driver)->driver;
      std::strncpy(name, kernel_driver ? "ftdi_sio" : "usbfs", sizeof(name) - 1);
      return 0;
    }
    case USBDEVFS_IOCTL:
      return driver_ioctl(client);
    case USBDEVFS_CLEAR_HALT: {
      const auto endpoint = resolve(arg, 0, sizeof(std::uint32_t));
      if (!endpoint) return -EFAULT;
      if (device->clear_error_ != 0) return -device->clear_error_;
      device->on_halt_cleared(static_cast<std::uint8_t>(*as<std::uint32_t>(endpoint)));
      return 0;
    }
    case USBDEVFS_RESET:
      finish_all(-ESHUTDOWN);
      device->on_reset();
      return 0;
    case USBDEVFS_SETINTERFACE:
    case USBDEVFS_SETCONFIGURATION:
      return 0;
    case USBDEVFS_SUBMITURB:
      return submit(client);
    case USBDEVFS_DISCARDURB: {
      std::uint64_t address = 0;
      std::memcpy(&address, arg->data, sizeof(address));
      return discard_at(client, address);
    }
    default:
      return -ENOTTY;
  }
}

}  // namespace fpga_stereo::sim
