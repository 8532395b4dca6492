// The end of a serial line on which a virtual board is; the line is a pseudo terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

class PtyPort {
 public:
  /// Creates an unplugged port. While it is plugged in, `path` is a symbolic link that the host
  /// opens. Throws std::runtime_error if `path` exists and is not a symbolic link.
  explicit PtyPort(std::string path);
  ~PtyPort();
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;

  /// Plugs the port in or out, and discards all bytes in flight. Throws std::runtime_error if the
  /// pseudo terminal or the link cannot be created.
  void plug(bool plugged);
  bool is_plugged() const { return master_ >= 0; }
  const std::string& path() const { return path_; }
  /// Returns whether a host has opened the path.
  bool has_host() const;

  /// Moves bytes in both directions once. Discards the bytes to the host if no host is connected.
  /// Returns whether any bytes moved.
  bool move(Board& board);
  /// Blocks until there are bytes to move or `timeout` expires.
  void wait(std::chrono::milliseconds timeout) const;

 private:
  void close_line();
  bool move_from_host(Board& board);
  bool move_to_host(Board& board);

  const std::string path_;
  int master_ = -1;
  std::vector<std::uint8_t> from_host_, to_host_;  // not yet passed on
};

}  // namespace fpga_stereo::sim
