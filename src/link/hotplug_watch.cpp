#include "link/hotplug_watch.hpp"

#include <libusb.h>

#include <atomic>
#include <thread>

#include "core/thread_safety.hpp"
#include "link/clock.hpp"
#include "link/usb_device.hpp"

namespace fpga_stereo::link {

struct HotplugWatch::State {
  Mutex mutex;
  UsbContext context FPGA_STEREO_GUARDED_BY(mutex);  // null until libusb starts
  libusb_hotplug_callback_handle callback = 0;
  bool registered = false;
  std::atomic<bool> has_changed{false}, is_interrupted{false};

  UsbContext get() FPGA_STEREO_EXCLUDES(mutex) {
    const MutexLock lock(mutex);
    return context;
  }
  /// Starts libusb and asks for its hotplug events.
  void start() FPGA_STEREO_EXCLUDES(mutex);
  static int LIBUSB_CALL on_change(libusb_context*, libusb_device*, libusb_hotplug_event,
                                   void* state) {
    static_cast<State*>(state)->has_changed = true;
    return 0;
  }
};

void HotplugWatch::State::start() {
  const auto made = make_usb_context();
  if (!made) return;
  {
    const MutexLock lock(mutex);
    context = *made;
  }
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return;
  const int events = LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT;
  registered = libusb_hotplug_register_callback(
                   made->get(), static_cast<libusb_hotplug_event>(events),
                   static_cast<libusb_hotplug_flag>(0), kUsbVendor, kUsbProduct,
                   LIBUSB_HOTPLUG_MATCH_ANY, &State::on_change, this, &callback) == LIBUSB_SUCCESS;
}

HotplugWatch::HotplugWatch() : state_(std::make_unique<State>()) { state_->start(); }

HotplugWatch::~HotplugWatch() {
  if (state_->registered) {
    libusb_hotplug_deregister_callback(state_->get().get(), state_->callback);
  }
}

bool HotplugWatch::wait(std::chrono::milliseconds timeout) {
  const auto until = Clock::now() + timeout;
  while (!state_->has_changed && !state_->is_interrupted) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) break;
    const UsbContext context = state_->get();
    if (!context) {
      std::this_thread::sleep_for(std::min(left, std::chrono::milliseconds(100)));
      state_->start();
      if (state_->get()) state_->has_changed = true;  // a board may have come before
      continue;
    }
    // In pieces, because libusb misses an interrupt that comes between the check above and this
    // call.
    const auto part = std::min(left, std::chrono::milliseconds(500));
    timeval part_timeout{0, static_cast<suseconds_t>(part.count() * 1000)};
    libusb_handle_events_timeout_completed(context.get(), &part_timeout, nullptr);
  }
  if (state_->is_interrupted.exchange(false)) return false;
  return state_->has_changed.exchange(false);
}

void HotplugWatch::interrupt() {
  state_->is_interrupted = true;
  if (const UsbContext context = state_->get()) libusb_interrupt_event_handler(context.get());
}

}  // namespace fpga_stereo::link
