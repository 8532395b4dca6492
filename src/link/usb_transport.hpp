// The transfers of one board. Buffers go round: free, in flight, arrived; read() empties the
// oldest one that has arrived and gives it back. So what is received is bounded, nothing of it is
// lost, and a reader that stops stops the board.
#pragma once

#include <libusb.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "link/usb.hpp"
#include "link/usb_device.hpp"

namespace fpga_stereo::link {

class UsbTransport : public Transport {
 public:
  /// Of a chip that has been set up.
  UsbTransport(UsbDevice device, const UsbOptions& options);
  UsbTransport(const UsbTransport&) = delete;
  UsbTransport& operator=(const UsbTransport&) = delete;
  ~UsbTransport() override;

  /// Starts the thread and the transfers.
  Status start();

  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override;
  Status recover(Recovery step) override;
  std::string description() const override { return device_.name; }
  Counters counters() const override;

 private:
  struct FreeTransfer {
    void operator()(libusb_transfer* transfer) const { libusb_free_transfer(transfer); }
  };
  struct Buffer {
    UsbTransport* owner = nullptr;
    std::unique_ptr<libusb_transfer, FreeTransfer> transfer;
    std::vector<std::uint8_t> bytes;
    std::size_t begin = 0, end = 0;  // what is left to be read
    bool flying = false;
  };
  static void LIBUSB_CALL received(libusb_transfer* transfer);
  static void LIBUSB_CALL sent(libusb_transfer* transfer);

  // With the lock.
  void take(Buffer& buffer);
  void submit();
  void fail(int code, const std::string& what);
  void cancel();
  bool idle() const { return flying_ == 0 && !out_.flying; }

  void run();
  void overcome_halt();
  bool clear_halt(std::uint8_t endpoint);
  std::optional<std::size_t> send(std::size_t size, std::chrono::steady_clock::time_point until);
  /// Stops the transfers: whether they have ended.
  bool pause();
  void resume();

  UsbDevice device_;
  const UsbOptions options_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Buffer> buffers_;
  std::deque<Buffer*> free_, arrived_;
  int flying_ = 0;
  Buffer out_;
  bool paused_ = true;
  bool halted_ = false;  // the endpoint of the data that are received
  int halts_in_a_row_ = 0;
  std::optional<Error> failed_;
  Counters counters_;

  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace fpga_stereo::link
