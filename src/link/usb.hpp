// A board on USB: an FT232H (0403:6014) in synchronous 245 FIFO mode, by libusb. Nothing of libusb
// is seen here.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

constexpr std::uint16_t kUsbVendor = 0x0403, kUsbProduct = 0x6014;

struct UsbSelection {
  enum class By {
    kFirst,   // by bus and port
    kSerial,  // the whole serial number
    kPort,    // bus and ports: 1-2.3
    kMatch,   // a regular expression (ECMAScript), found in serial number or product name
  };
  By by = By::kFirst;
  std::string value;
};

struct UsbOptions {
  // A transfer ends when it is full or the chip has nothing more for latency_ms: the larger, the
  // later the rows of a slow stream come. 64 KiB are 3.6 ms of disparity at 640 x 480, 30 f/s, and
  // 16 of them bridge 25 ms at the 42 MB/s that the chip can do, in which the host may be busy.
  int transfers = 16;
  std::size_t transfer_bytes = 65536;  // rounded up to whole packets
  /// What may wait for read(), transfers included: 100 ms at full speed. When it is full, nothing
  /// more is asked for, and the board has to wait.
  std::size_t buffer_bytes = std::size_t{4} << 20;
  int latency_ms = 2;  // of the chip, 1 to 255
};

/// Opens a board and starts its transfers. Errors as of open_transport().
Result<std::unique_ptr<Transport>> open_usb(const UsbSelection& selection,
                                            const UsbOptions& options = {});

std::vector<FoundDevice> list_usb();

}  // namespace fpga_stereo::link
