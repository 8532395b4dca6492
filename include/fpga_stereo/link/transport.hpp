// Transports move bytes between host and board, and can recover when they are stuck. They know
// nothing of packets, so that USB, serial lines, recordings and virtual boards look the same to the
// layers above.
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

/// Ways to recover a transport that brings nothing, mild to harsh. Whoever opened the transport may
/// close and open it again between the last two.
enum class Recovery {
  kPurge,    // clears halts and drops the bytes in the buffers of both sides
  kRestart,  // stops the transfers, sets the device up and starts again
  kReset,    // resets the device, as if it were plugged in again; close the transport afterwards
};

class Transport {
 public:
  using Timeout = std::chrono::milliseconds;

  /// Since the transport was opened.
  struct Counters {
    std::uint64_t bytes_in = 0, bytes_out = 0;
    std::uint64_t stalls = 0;  // halts and overruns that the transport recovered from
  };

  /// Closes the transport. Blocks for a second at most.
  virtual ~Transport() = default;

  /// Reads 1 to `size` bytes; blocks until some arrive. Returns 0 after `timeout`. Fails with
  /// kUnplugged if the device was unplugged (or the recording has ended), with kIo if the transport
  /// does not work. A failure lasts: kUnplugged for good, kIo until recover() succeeds.
  [[nodiscard]] virtual Result<std::size_t> read(std::uint8_t* bytes, std::size_t size,
                                                 Timeout timeout) = 0;

  /// Writes bytes. Returns how many the device accepted within `timeout`. Fails as read() does. One
  /// thread may write while another one reads.
  [[nodiscard]] virtual Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size,
                                                  Timeout timeout) = 0;

  /// Recovers the transport. Call from the thread that reads, while no thread writes. Blocks for
  /// two seconds at most.
  [[nodiscard]] virtual Status recover(Recovery step) = 0;

  /// Returns a text for people: "USB 1-2.3, serial number FT5X", "/dev/ttyUSB0 at 1000000 baud".
  virtual std::string description() const = 0;
  virtual Counters counters() const = 0;
};

/// A device that may be a board.
struct FoundDevice {
  std::string name;         // for open_transport(): "usb:port=1-2.3", "serial:/dev/..."
  std::string description;  // for people
};

/// Lists every USB device and serial line that may be a board. Sends nothing to any of them.
std::vector<FoundDevice> list_devices();

/// Opens a transport; called again whenever the transport was lost.
using Opener = std::function<Result<std::unique_ptr<Transport>>()>;

/// Opens a transport by name:
///
///   usb                  the first USB board
///   usb:serial=FT5X      the board with exactly this serial number
///   usb:port=1-2.3       the board at this bus and port
///   usb:match=REGEX      the first board whose serial number or product name matches
///   serial:PATH[:BAUD]   a serial line; default 1000000 baud
///   replay:FILE[:SPEED]  a recording, SPEED times as fast as recorded (default 1); 0: unlimited
///
/// Fails with kInvalid (not such a name), kNotFound, kBusy, kPermission or kIo; the message says
/// what was searched, what was found, and what helps.
Result<std::unique_ptr<Transport>> open_transport(const std::string& name);

/// Fails with kInvalid if open_transport() would, for a name that selects nothing.
Status check_transport_name(const std::string& name);

/// Returns a watch that signals when the device of this name may have come back; null for devices
/// without hotplug events.
std::shared_ptr<HotplugWatch> watch_for(const std::string& name);

}  // namespace fpga_stereo::link
