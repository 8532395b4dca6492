// A board on a serial line: /dev/ttyUSB0, or whatever else the kernel shows as one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

constexpr int kDefaultBaud = 1000000;  // what the board is built for

/// Opens a line for this program alone: 8 bits, no parity, 1 stop bit, no flow control. `baud` may
/// be any rate that the line's chip can make. Errors as of open_transport().
Result<std::unique_ptr<Transport>> open_serial(const std::string& path, int baud = kDefaultBaud);

/// Serial lines under `dev`: by their lasting names (serial/by-id) where there are such, else
/// ttyUSB* and ttyACM*.
std::vector<FoundDevice> list_serial(const std::string& dev = "/dev");

/// What an errno of open() or of the set-up of a line means.
Error serial_error(int code, const std::string& path);

}  // namespace fpga_stereo::link
