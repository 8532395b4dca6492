// Transport over USB: an FT232H (0403:6014) in synchronous 245 FIFO mode. This header does not
// expose libusb.
#pragma once

#include <cstddef>
#include <memory>
#include <regex>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

constexpr std::uint16_t kUsbVendor = 0x0403, kUsbProduct = 0x6014;

struct UsbSelection {
  enum class By {
    kFirst,   // in the order of bus and port
    kSerial,  // the whole serial number
    kPort,    // bus and ports: 1-2.3
    kMatch,   // a regular expression (ECMAScript), found in serial number or product name
  };
  By by = By::kFirst;
  std::string value;
};

struct UsbOptions {
  // A transfer ends when it is full, or when the chip has had nothing to send for latency_ms.
  // Larger transfers delay the rows of a slow stream: 64 KiB are 3.6 ms of disparity at 640 x 480,
  // 30 f/s. While the host is busy, 16 of them buffer 25 ms at the chip's maximum of 42 MB/s.
  int transfers = 16;
  std::size_t transfer_bytes = 65536;  // rounded up to whole packets
  /// Memory for received bytes, transfers included: 100 ms at full speed. While it is full, no
  /// transfer is submitted, and the board waits.
  std::size_t buffer_bytes = std::size_t{4} << 20;
  int latency_ms = 2;  // the chip's latency timer, 1 to 255
};

/// Compiles the regular expression of By::kMatch; any for other selections. Fails with kInvalid.
Result<std::regex> match_of(const UsbSelection& selection);

/// Opens a board and starts its transfers. Fails as open_transport() does.
Result<std::unique_ptr<Transport>> open_usb(const UsbSelection& selection,
                                            const UsbOptions& options = {});

/// Lists all FT232H devices.
std::vector<FoundDevice> list_usb();

}  // namespace fpga_stereo::link
