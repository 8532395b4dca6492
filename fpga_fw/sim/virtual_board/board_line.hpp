// Connects a transport directly to a virtual board in the same process, for tests.
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <mutex>

#include "fpga_stereo/link/transport.hpp"
#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

/// Thread-safe. The board's time follows the steady clock.
class BoardLine {
 public:
  explicit BoardLine(std::unique_ptr<Board> board) : board_(std::move(board)) {}

  /// Opens a transport to the board. Fails while the board is unplugged or another transport is
  /// open. The transport must not outlive this object.
  Result<std::unique_ptr<link::Transport>> open();
  /// Plugs or unplugs the board. While it is unplugged, an open transport fails with kUnplugged.
  void plug(bool is_plugged);
  /// While the line is held, reads return nothing and writes are discarded without an error.
  void hold(bool is_held);
  void feed(const GreyPair& pair);
  void reset_board();
  /// Returns how often the host requested a recovery step.
  int recovered(link::Recovery step) const;

 private:
  class Line;
  void pass_time();

  mutable std::mutex mutex_;
  std::unique_ptr<Board> board_;
  std::chrono::steady_clock::time_point last_run_ = std::chrono::steady_clock::now();
  bool is_plugged_ = true, is_held_ = false, is_open_ = false;
  std::array<int, 3> recovered_{};  // by Recovery
};

}  // namespace fpga_stereo::sim
