// Boards on USB: which there are, and one of them open. For the files beside this one.
#pragma once

#include <libusb.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"
#include "link/usb.hpp"

namespace fpga_stereo::link {

using UsbContext = std::shared_ptr<libusb_context>;

Result<UsbContext> make_usb_context();

/// What a code of libusb means; `what` begins the message: "USB 1-2.3 cannot be opened".
Error usb_error(int code, const std::string& what);

/// Open, with interface 0 claimed. The last copy closes it.
struct UsbDevice {
  UsbContext context;
  std::shared_ptr<libusb_device_handle> handle;
  std::string name;  // "USB 1-2.3, serial number FT5X"
  std::uint8_t in = 0, out = 0;
  std::size_t packet = 512;  // wMaxPacketSize

  /// Vendor requests, to the device.
  Status send(std::uint8_t request, std::uint16_t value, std::uint16_t index = 0) const;
  Status receive(std::uint8_t request, std::uint16_t index, std::uint8_t* bytes,
                 std::uint16_t size) const;
};

Result<UsbDevice> open_usb_device(const UsbSelection& selection);

/// The chip as an empty synchronous 245 FIFO.
Status set_up_ftdi(const UsbDevice& device, int latency_ms);
/// Drops what waits in the chip, for both sides.
Status purge_ftdi(const UsbDevice& device);

}  // namespace fpga_stereo::link
