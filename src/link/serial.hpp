// Transport over a serial line, such as /dev/ttyUSB0.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

constexpr int kDefaultBaud = 1000000;  // of the gateware

/// Opens a serial line exclusively: 8 bits, no parity, 1 stop bit, no flow control. `baud` may be
/// any rate that the line's chip supports. Fails as open_transport() does.
Result<std::unique_ptr<Transport>> open_serial(const std::string& path, int baud = kDefaultBaud);

/// Lists the serial lines under `dev`: those in serial/by-id, whose names are stable; if there are
/// none, ttyUSB* and ttyACM*.
std::vector<FoundDevice> list_serial(const std::string& dev = "/dev");

/// Describes an errno that opening or setting up a serial line gave.
Error serial_error(int code, const std::string& path);

}  // namespace fpga_stereo::link
