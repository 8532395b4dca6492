// The transfers of one USB board. Each buffer is free, in flight or has arrived; read() empties the
// oldest that has arrived and frees it. So memory is bounded, nothing that was received is lost,
// and a reader that stops makes the board wait.
#pragma once

#include <libusb.h>

#include <atomic>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/thread_safety.hpp"
#include "link/clock.hpp"
#include "link/usb.hpp"
#include "link/usb_device.hpp"

namespace fpga_stereo::link {

class UsbTransport : public Transport {
 public:
  /// Takes a chip that has been set up; see set_up_ftdi().
  UsbTransport(UsbDevice device, const UsbOptions& options);
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;
  ~UsbTransport() override;

  /// Starts the thread that handles libusb's events, and the transfers.
  Status start() FPGA_STEREO_EXCLUDES(mutex_);

  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override
      FPGA_STEREO_EXCLUDES(mutex_);
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override
      FPGA_STEREO_EXCLUDES(mutex_);
  Status recover(Recovery step) override FPGA_STEREO_EXCLUDES(mutex_);
  std::string description() const override { return device_.name; }
  Counters counters() const override FPGA_STEREO_EXCLUDES(mutex_);

 private:
  struct FreeTransfer {
    void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
  };
  struct Buffer {
    UsbTransport* owner = nullptr;
    std::unique_ptr<libusb_transfer, FreeTransfer> transfer;
    std::vector<std::uint8_t> bytes;
    std::size_t begin = 0, end = 0;  // bytes not read yet
    bool is_in_flight = false;
  };
  // libusb's callbacks. They run in whichever thread handles libusb's events, and lock the mutex.
  static void LIBUSB_CALL on_received(libusb_transfer* transfer);
  static void LIBUSB_CALL on_sent(libusb_transfer* transfer);

  void take(Buffer& buffer) FPGA_STEREO_EXCLUDES(mutex_);
  /// Submits free buffers, as many as may be in flight.
  void submit() FPGA_STEREO_REQUIRES(mutex_);
  void fail(int code, const std::string& what) FPGA_STEREO_REQUIRES(mutex_);
  void cancel() FPGA_STEREO_REQUIRES(mutex_);
  bool is_idle() const FPGA_STEREO_REQUIRES(mutex_) {
    return in_flight_ == 0 && !out_.is_in_flight;
  }

  void run();
  void overcome_halt() FPGA_STEREO_EXCLUDES(mutex_);
  bool clear_halt(std::uint8_t endpoint) FPGA_STEREO_EXCLUDES(mutex_);
  /// Sends the first `size` bytes of the out buffer. Returns how many the chip took until the
  /// deadline; nullopt if the transport failed.
  std::optional<std::size_t> send(std::size_t size, Time deadline) FPGA_STEREO_EXCLUDES(mutex_);
  /// Stops the transfers. Returns true if all have ended within a second.
  bool pause() FPGA_STEREO_EXCLUDES(mutex_);
  void resume() FPGA_STEREO_EXCLUDES(mutex_);

  UsbDevice device_;
  const UsbOptions options_;

  mutable Mutex mutex_;
  ConditionVariable changed_;
  /// The bytes of a buffer belong to libusb while it is in flight.
  std::deque<Buffer> buffers_ FPGA_STEREO_GUARDED_BY(mutex_);
  std::deque<Buffer*> free_ FPGA_STEREO_GUARDED_BY(mutex_), arrived_ FPGA_STEREO_GUARDED_BY(mutex_);
  int in_flight_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;  // buffers
  Buffer out_ FPGA_STEREO_GUARDED_BY(mutex_);
  bool is_paused_ FPGA_STEREO_GUARDED_BY(mutex_) = true;
  bool is_halted_ FPGA_STEREO_GUARDED_BY(mutex_) = false;  // the endpoint that receives
  int halts_in_a_row_ FPGA_STEREO_GUARDED_BY(mutex_) = 0;
  std::optional<Error> failure_ FPGA_STEREO_GUARDED_BY(mutex_);
  Counters counters_ FPGA_STEREO_GUARDED_BY(mutex_);

  std::atomic<bool> is_stopping_{false};
  std::thread thread_;
};

}  // namespace fpga_stereo::link
