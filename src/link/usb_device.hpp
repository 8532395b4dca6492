// Finds and opens boards on USB.
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

/// Starts libusb. The last copy of the context stops it.
Result<UsbContext> make_usb_context();

/// Describes an error code of libusb. The message begins with `what`: "USB 1-2.3 cannot be opened".
Error usb_error(int code, const std::string& what);

/// An open device with interface 0 claimed. The last copy closes it.
struct UsbDevice {
  UsbContext context;
  std::shared_ptr<libusb_device_handle> handle;
  std::string name;              // "USB 1-2.3, serial number FT5X"
  std::uint8_t in = 0, out = 0;  // endpoints
  std::size_t packet = 512;      // wMaxPacketSize

  /// Sends a vendor request without data to the device.
  Status send(std::uint8_t request, std::uint16_t value, std::uint16_t index = 0) const;
  /// Sends a vendor request and receives `size` bytes.
  Status receive(std::uint8_t request, std::uint16_t index, std::uint8_t* bytes,
                 std::uint16_t size) const;
};

/// Opens the selected board and claims its interface.
Result<UsbDevice> open_usb_device(const UsbSelection& selection);

/// Sets the chip up as an empty synchronous 245 FIFO.
Status set_up_ftdi(const UsbDevice& device, int latency_ms);
/// Drops the bytes in the chip's buffers, both directions.
Status purge_ftdi(const UsbDevice& device);

}  // namespace fpga_stereo::link
