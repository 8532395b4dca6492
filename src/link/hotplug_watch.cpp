#include "link/hotplug_watch.hpp"

#include <libusb.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "link/usb_device.hpp"

namespace fpga_stereo::link {

struct HotplugWatch::State {
  std::mutex mutex;    // wait() makes the context where interrupt() may want it
  UsbContext context;  // none as long as libusb does not start
  libusb_hotplug_callback_handle callback = 0;
  bool registered = false;
  std::atomic<int> changed{0}, interrupted{0};

  UsbContext get() {
    const std::lock_guard<std::mutex> lock(mutex);
    return context;
  }
  void start();
  static int LIBUSB_CALL on_change(libusb_context*, libusb_device*, libusb_hotplug_event,
                                   void* state) {
    static_cast<State*>(state)->changed = 1;
    return 0;
  }
};

void HotplugWatch::State::start() {
  const auto made = make_usb_context();
  if (!made) return;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    context = *made;
  }
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return;
  const int events = LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT;
  registered = libusb_hotplug_register_callback(
                   context.get(), static_cast<libusb_hotplug_event>(events),
                   static_cast<libusb_hotplug_flag>(0), kUsbVendor, kUsbProduct,
                   LIBUSB_HOTPLUG_MATCH_ANY, &State::on_change, this, &callback) == LIBUSB_SUCCESS;
}

HotplugWatch::HotplugWatch() : state_(std::make_unique<State>()) { state_->start(); }

HotplugWatch::~HotplugWatch() {
  if (state_->registered) {
    libusb_hotplug_deregister_callback(state_->context.get(), state_->callback);
  }
}

bool HotplugWatch::wait(std::chrono::milliseconds timeout) {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + timeout;
  while (state_->changed == 0 && state_->interrupted == 0) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) break;
    const UsbContext context = state_->get();
    if (!context) {
      std::this_thread::sleep_for(std::min(left, std::chrono::milliseconds(100)));
      state_->start();
      if (state_->get()) state_->changed = 1;  // whatever has come until now
      continue;
    }
    // In pieces: an interrupt between the question above and this call would be lost otherwise.
    const auto piece = std::min(left, std::chrono::milliseconds(500));
    timeval wait{0, static_cast<suseconds_t>(piece.count() * 1000)};
    libusb_handle_events_timeout_completed(context.get(), &wait, nullptr);
  }
  if (state_->interrupted.exchange(0) != 0) return false;
  return state_->changed.exchange(0) != 0;
}

void HotplugWatch::interrupt() {
  state_->interrupted = 1;
  if (const UsbContext context = state_->get()) libusb_interrupt_event_handler(context.get());
}

}  // namespace fpga_stereo::link
