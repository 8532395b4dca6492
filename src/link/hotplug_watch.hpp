// Tells that a USB board has come or gone, at once.
#pragma once

#include <chrono>
#include <memory>

namespace fpga_stereo::link {

/// Wakes who waits for a board. Where libusb cannot tell of boards that come and go, every wait
/// takes its full time.
class HotplugWatch {
 public:
  HotplugWatch();
  ~HotplugWatch();
  HotplugWatch(const HotplugWatch&) = delete;
  HotplugWatch& operator=(const HotplugWatch&) = delete;

  /// Whether a board has come or gone since the last call, at the latest after `timeout`. False,
  /// too, after interrupt().
  bool wait(std::chrono::milliseconds timeout);
  /// Ends a wait() of another thread, or else the next one.
  void interrupt();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fpga_stereo::link
