// The line between a virtual board and its host.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_board/faulty_board.hpp"

namespace fpga_stereo::tools {

class Line {
 public:
  virtual ~Line() = default;

  /// Moves bytes, and waits up to `timeout` for more.
  virtual void serve(std::chrono::milliseconds timeout) = 0;
  virtual void plug(bool is_plugged) = 0;
  /// Returns the exit code of the host program when it has ended; nullopt until then.
  virtual std::optional<int> exit_code() { return std::nullopt; }
  /// Returns the path that the host opens, or the USB device controller that it is connected to;
  /// empty if the line starts the host itself.
  virtual std::string path() const { return ""; }

  // Faults of USB; other lines ignore them.
  /// Halts the endpoint until the host clears it.
  virtual void halt() {}
  /// Ends the next transfers without a byte.
  virtual void send_empty(int /*num_transfers*/) {}
  /// Limits the payload of packets, bytes; 0: no limit.
  virtual void limit_packets(int /*payload*/) {}
};

/// Creates a pseudo terminal; `path` becomes a symbolic link to it. Throws std::runtime_error.
std::unique_ptr<Line> make_pty_line(sim::FaultyBoard& board, const std::string& path);

/// Creates a virtual FT232H and starts `command`, which sees it. Throws std::runtime_error, also if
/// the program was built without umockdev.
std::unique_ptr<Line> make_usb_line(sim::FaultyBoard& board, const std::string& serial_number,
                                    const std::vector<std::string>& command);

/// Creates a virtual FT232H that the kernel of this machine presents to its USB host. Throws
/// std::runtime_error, also if this machine cannot be a USB device.
std::unique_ptr<Line> make_gadget_line(sim::FaultyBoard& board, const std::string& serial_number);

}  // namespace fpga_stereo::tools
