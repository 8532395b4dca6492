// Signals that a USB board was plugged in or unplugged.
#pragma once

#include <chrono>
#include <memory>

namespace fpga_stereo::link {

/// Wakes a thread that waits for a board. If libusb has no hotplug events, every wait takes its
/// full time.
class HotplugWatch {
 public:
  HotplugWatch();
  ~HotplugWatch();
  HotplugWatch(const HotplugWatch&) = delete;
  HotplugWatch& operator=(const HotplugWatch&) = delete;

  /// Waits up to `timeout` for a board to come or go. Returns true if one has since the last call;
  /// false also after interrupt(). Only one thread may wait.
  bool wait(std::chrono::milliseconds timeout);
  /// Ends the wait() of another thread, or, if none waits, the next one.
  void interrupt();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fpga_stereo::link
