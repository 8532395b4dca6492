// The board's end of a serial line that is a pseudo terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

class PtyPort {
 public:
  /// The host opens `path`, a symbolic link that lasts while the port is plugged in. Throws
  /// std::runtime_error where the path is taken or cannot be made. Not plugged in yet.
  explicit PtyPort(std::string path);
  ~PtyPort();
  PtyPort(const PtyPort&) = delete;
  PtyPort& operator=(const PtyPort&) = delete;

  /// Bytes that are under way are lost.
  void plug(bool plugged);
  bool plugged() const { return master_ >= 0; }
  const std::string& path() const { return path_; }
  /// Whether somebody has opened the path.
  bool has_host() const;

  /// Bytes both ways, once; to the host only where there is one, else they are dropped. Whether any
  /// have moved.
  bool move(Board& board);
  /// Until there is something to move, at most so long.
  void wait(std::chrono::milliseconds most) const;

 private:
  void close_line();
  bool move_from_host(Board& board);
  bool move_to_host(Board& board);

  const std::string path_;
  int master_ = -1;
  std::vector<std::uint8_t> from_host_, to_host_;  // that have not gone on yet
};

}  // namespace fpga_stereo::sim
