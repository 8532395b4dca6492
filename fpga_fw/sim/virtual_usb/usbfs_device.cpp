#include "sim/virtual_usb/usbfs_device.hpp"

#include <umockdev.h>

#include <cerrno>
#include <stdexcept>
#include <utility>

#include "sim/virtual_usb/usb_testbed.hpp"
#include "sim/virtual_usb/usbfs_session.hpp"

namespace fpga_stereo::sim {

int UsbfsDevice::handle_ioctl(void*, UMockdevIoctlClient* client, void* session) {
  const int answer = (*static_cast<std::shared_ptr<Session>*>(session))->answer(client);
  umockdev_ioctl_client_complete(client, answer < 0 ? -1 : answer, answer < 0 ? -answer : 0);
  return TRUE;
}

void UsbfsDevice::handle_connected(void*, UMockdevIoctlClient* client, void* session) {
  // A client is destroyed when it closes its file: this ends its transfers.
  auto* held = new std::shared_ptr<Session>(*static_cast<std::shared_ptr<Session>*>(session));
  {
    const std::lock_guard lock((*held)->shared->mutex);
    ++(*held)->shared->clients;
  }
  const auto closed = +[](gpointer data, GObject* gone) {
    auto* closed_session = static_cast<std::shared_ptr<Session>*>(data);
    (*closed_session)->remove_client(gone);
    delete closed_session;
  };
  g_object_weak_ref(G_OBJECT(client), closed, held);
}

UsbfsDevice::UsbfsDevice(Identity identity)
    : identity_(std::move(identity)), shared_(std::make_shared<Shared>()) {}

UsbfsDevice::~UsbfsDevice() = default;

std::mutex& UsbfsDevice::mutex() const { return shared_->mutex; }

bool UsbfsDevice::is_plugged() const {
  const std::lock_guard lock(mutex());
  return plugged_in();
}

bool UsbfsDevice::wait_until_closed(std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex());
  return shared_->closed.wait_for(lock, timeout, [&] { return shared_->clients == 0; });
}

std::deque<UsbfsDevice::UrbPtr>& UsbfsDevice::urbs(std::uint8_t endpoint) {
  return session_ ? session_->queue(endpoint) : no_urbs_;
}

void UsbfsDevice::finish(const UrbPtr& urb, int status) {
  if (session_) session_->finish(urb, urb->is_discarded ? -ENOENT : status);
}

void UsbfsDevice::refuse_claims(int error) {
  const std::lock_guard lock(mutex());
  claim_error_ = error;
}

void UsbfsDevice::refuse_clearing(int error) {
  const std::lock_guard lock(mutex());
  clear_error_ = error;
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
  session->is_ready = true;  // a new FIFO is empty
  session->show_ready();
  {
    const std::lock_guard lock(mutex());
    if (session_) throw std::logic_error("the device is plugged in already");
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
