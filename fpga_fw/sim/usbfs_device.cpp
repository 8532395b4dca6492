#include "sim/usbfs_device.hpp"

#include <fcntl.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "sim/usb_testbed.hpp"

namespace fpga_stereo::sim {
namespace {

using Data = std::shared_ptr<UMockdevIoctlData>;

/// The memory that the pointer at `offset` points to, in the process of the client. Only while the
/// client waits for its answer.
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
  UMockdevIoctlBase* handler = nullptr;
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

  int submit(UMockdevIoctlClient* client);
  int reap(UMockdevIoctlClient* client);
  int discard_at(const void* client, std::uint64_t address);
  int claim(const void* client, bool disconnect);
  int release(const void* client);
  int driver_ioctl(UMockdevIoctlClient* client);
  int answer(UMockdevIoctlClient* client);
};

void UsbfsDevice::Session::vanished(const void* client) {
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
    device->submitted();
    return 0;
  }
  if (urb->size < 8) return -EINVAL;
  const auto& bytes = urb->bytes;
  const auto u16 = [&](std::size_t at) {
    return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
  };
  const Setup setup{bytes[0], bytes[1], u16(2), u16(4), u16(6)};
  std::vector<std::uint8_t> contents(bytes.begin() + 8, bytes.end());
  const bool in_data = (setup.type & 0x80) != 0;
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
  const std::size_t skip = is_in ? 0 : 8;  // the setup of a control transfer
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
      if (urb->client != client || urb->address != address || urb->discarded) continue;
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
      // As with xHCI and EHCI: libusb makes one URB of a transfer of any size.
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
      device->halt_cleared(static_cast<std::uint8_t>(*as<std::uint32_t>(endpoint)));
      return 0;
    }
    case USBDEVFS_RESET:
      finish_all(-ESHUTDOWN);
      device->reset();
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

int UsbfsDevice::handle_ioctl(void*, UMockdevIoctlClient* client, void* session) {
  const int answer = (*static_cast<std::shared_ptr<Session>*>(session))->answer(client);
  umockdev_ioctl_client_complete(client, answer < 0 ? -1 : answer, answer < 0 ? -answer : 0);
  return TRUE;
}

void UsbfsDevice::handle_connected(void*, UMockdevIoctlClient* client, void* session) {
  // That a client has closed its file shows only here; its transfers end then.
  auto* held = new std::shared_ptr<Session>(*static_cast<std::shared_ptr<Session>*>(session));
  {
    const std::lock_guard lock((*held)->shared->mutex);
    ++(*held)->shared->clients;
  }
  const auto closed = +[](gpointer data, GObject* gone) {
    auto* session_of_it = static_cast<std::shared_ptr<Session>*>(data);
    (*session_of_it)->vanished(gone);
    delete session_of_it;
  };
  g_object_weak_ref(G_OBJECT(client), closed, held);
}

UsbfsDevice::UsbfsDevice(Identity identity)
    : identity_(std::move(identity)), shared_(std::make_shared<Shared>()) {}

UsbfsDevice::~UsbfsDevice() = default;

std::mutex& UsbfsDevice::mutex() const { return shared_->mutex; }

bool UsbfsDevice::plugged() const {
  const std::lock_guard lock(mutex());
  return plugged_in();
}

bool UsbfsDevice::wait_until_closed(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex());
  return shared_->closed.wait_for(lock, timeout, [&] { return shared_->clients == 0; });
}

std::deque<UsbfsDevice::UrbPtr>& UsbfsDevice::urbs(std::uint8_t endpoint) {
  return session_ ? session_->queue(endpoint) : none_;
}

void UsbfsDevice::finish(const UrbPtr& urb, int status) {
  if (session_) session_->finish(urb, urb->discarded ? -ENOENT : status);
}

void UsbfsDevice::refuse_claims(int error) {
  const std::lock_guard lock(mutex());
  claim_error_ = error;
}

void UsbfsDevice::place_devices(const std::string& folder) { UsbTestbed::get().move_to(folder); }

std::vector<std::string> UsbfsDevice::environment() { return UsbTestbed::get().environment(); }

void UsbfsDevice::permit(bool others) {
  const std::lock_guard lock(mutex());
  if (session_) UsbTestbed::get().permit(session_->node, others);
}

void UsbfsDevice::plug() {
  auto& testbed = UsbTestbed::get();
  auto session = std::make_shared<Session>();
  session->shared = shared_;
  session->kernel_driver = identity_.kernel_driver;
  session->handler = umockdev_ioctl_base_new();
  const auto hold = [&] { return new std::shared_ptr<Session>(session); };
  const auto release =
      +[](gpointer data, GClosure*) { delete static_cast<std::shared_ptr<Session>*>(data); };
  g_signal_connect_data(session->handler, "handle-ioctl", G_CALLBACK(&handle_ioctl), hold(),
                        release, GConnectFlags{});
  g_signal_connect_data(session->handler, "client-connected", G_CALLBACK(&handle_connected), hold(),
                        release, GConnectFlags{});
  session->node = testbed.make_node(session->handler, session->fifo);
  session->ready = true;  // an empty FIFO
  session->show_ready();
  {
    const std::lock_guard lock(mutex());
    if (session_) throw std::logic_error("plugged in already");
    session->device = this;
    session_ = session;
  }
  session->syspath = testbed.add(identity_, session->node);
}

void UsbfsDevice::unplug() {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex());
    if (!session_) return;
    session = std::exchange(session_, nullptr);
    session->device = nullptr;
    session->claimed_by = nullptr;
    session->finish_all(-ESHUTDOWN);
  }
  UsbTestbed::get().remove(session->syspath, session->node);
  g_object_unref(session->handler);
}

}  // namespace fpga_stereo::sim
