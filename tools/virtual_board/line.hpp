// How a virtual board is reached.
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

  /// Moves bytes, and waits for more of them for so long at most.
  virtual void serve(std::chrono::milliseconds most) = 0;
  virtual void plug(bool plugged) = 0;
  /// An exit code, once there is nobody left to serve.
  virtual std::optional<int> ended() { return std::nullopt; }
  /// What is printed when the host may come; empty: nothing.
  virtual std::string ready() const { return ""; }

  // Faults that only USB has.
  virtual void halt() {}              // until the host clears it
  virtual void send_empty(int) {}     // so many transfers without a byte
  virtual void limit_packets(int) {}  // bytes of payload in a packet at most; 0: as usual
};

/// A pseudo terminal; `path` becomes a symbolic link to it. Throws std::runtime_error.
std::unique_ptr<Line> make_pty_line(sim::FaultyBoard& board, const std::string& path);

/// An emulated FT232H that `command` sees, which is started. Throws std::runtime_error, always so
/// where the programs were built without umockdev.
std::unique_ptr<Line> make_usb_line(sim::FaultyBoard& board, const std::string& serial_number,
                                    const std::vector<std::string>& command);

}  // namespace fpga_stereo::tools
