// What a virtual USB device and the connection that carries it say to each other.
#pragma once

#include <cstdint>
#include <string>

namespace fpga_stereo::sim {

/// The setup packet of a control transfer (USB 2.0, section 9.3).
struct UsbSetup {
  std::uint8_t type, request;
  std::uint16_t value, index, length;

  bool is_in() const { return (type & 0x80) != 0; }
};

/// What a device says about itself in its descriptors.
struct UsbIdentity {
  std::uint16_t vendor = 0, product = 0, release = 0;
  std::string manufacturer, product_name, serial_number;
};

}  // namespace fpga_stereo::sim
