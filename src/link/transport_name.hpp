// Parses the names of transports.
#pragma once

#include <string>

#include "fpga_stereo/core/result.hpp"
#include "link/usb.hpp"

namespace fpga_stereo::link {

/// What the name of a transport selects.
struct TransportName {
  enum class Kind { kUsb, kSerial, kReplay } kind = Kind::kUsb;
  UsbSelection usb;
  std::string path;   // serial, replay
  double number = 0;  // baud rate, speed
};

/// Fails with kInvalid for a name that selects nothing.
Result<TransportName> parse_transport_name(const std::string& name);

}  // namespace fpga_stereo::link
