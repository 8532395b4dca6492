// A line that carries bytes both ways, and what can be done to one that is stuck. A transport knows
// nothing of packets: USB, serial, a recorded file and a board that is simulated are all the same
// to what stands above.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo::link {

class HotplugWatch;

/// What can be done to a line on which nothing comes any more, mild to harsh. Opening it anew comes
/// between the last two; that is up to who opened it.
enum class Recovery {
  kPurge,    // halts are cleared, what waits in buffers on both sides is dropped
  kRestart,  // the transfers are stopped, the line is set up and started again
  kReset,    // the device is reset, as if it were plugged in anew; the transport is to be closed
};

class Transport {
 public:
  using Timeout = std::chrono::milliseconds;

  /// Since the transport was opened.
  struct Counters {
    std::uint64_t bytes_in = 0, bytes_out = 0;
    std::uint64_t stalls = 0;  // times the line's own errors were overcome (halts, overruns)
  };

  /// Closes the line; waits for nothing longer than a second.
  virtual ~Transport() = default;

  /// Bytes that have come: 1 to `size` of them, or 0 where none came within `timeout`. Fails with
  /// kUnplugged where the device has been unplugged (or the file has ended), with kIo where the
  /// line does not work; a transport that has failed so fails again, with kIo until recover()
  /// succeeds.
  [[nodiscard]] virtual Result<std::size_t> read(std::uint8_t* bytes, std::size_t size,
                                                 Timeout timeout) = 0;

  /// Sends bytes: how many went within `timeout`; fewer than `size` where the device takes no more.
  /// Fails as read() does. One thread may write while another one reads.
  [[nodiscard]] virtual Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size,
                                                  Timeout timeout) = 0;

  /// By the thread that reads, while nobody writes. Takes two seconds at most.
  [[nodiscard]] virtual Status recover(Recovery step) = 0;

  /// For people: "USB 1-2.3, serial number FT5X", "/dev/ttyUSB0 at 1000000 baud".
  virtual std::string description() const = 0;
  virtual Counters counters() const = 0;
};

/// A line on which there may be a board.
struct FoundDevice {
  std::string name;         // that open_transport() takes: "usb:port=1-2.3", "serial:/dev/..."
  std::string description;  // for people
};

/// Every USB device and serial line that may be a board.
std::vector<FoundDevice> list_devices();

/// What opens a transport, called again whenever the line was lost.
using Opener = std::function<Result<std::unique_ptr<Transport>>()>;

/// Opens a line by name:
///
///   usb                  the first USB board
///   usb:serial=FT5X      that with this serial number, all of it
///   usb:port=1-2.3       that at this bus and port
///   usb:match=REGEX      the first whose serial number or product name has a match
///   serial:PATH[:BAUD]   a serial line, at 1000000 baud unless told
///   replay:FILE[:SPEED]  what was recorded, at SPEED times its own pace; 0: as fast as it is read
///
/// Fails with kInvalid (a name that is none of these), kNotFound, kBusy, kPermission or kIo; the
/// message says what was looked for, what is there, and what helps.
Result<std::unique_ptr<Transport>> open_transport(const std::string& name);

/// What tells that the line of this name may have come back; null: nothing does.
std::shared_ptr<HotplugWatch> watch_for(const std::string& name);

}  // namespace fpga_stereo::link
