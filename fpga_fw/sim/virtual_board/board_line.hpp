// A line straight to a board that is a program, for tests: no operating system between them.
#pragma once

#include <chrono>
#include <memory>
#include <mutex>

#include "fpga_stereo/link/transport.hpp"
#include "sim/virtual_board/board.hpp"

namespace fpga_stereo::sim {

/// Thread-safe. The board's time is that of the clock on the wall.
class BoardLine {
 public:
  explicit BoardLine(std::unique_ptr<Board> board) : board_(std::move(board)) {}

  /// A transport to the board; fails while it is unplugged, and while another one is open.
  Result<std::unique_ptr<link::Transport>> open();
  /// Unplugged: transports that are open fail with kUnplugged.
  void plug(bool plugged);
  /// Held: nothing passes, and the transport knows of nothing.
  void hold(bool held);
  void feed(const GreyPair& pair);
  void reset_board();
  /// How often each step of recovery was asked for.
  int recovered(link::Recovery step) const;

 private:
  class Line;
  void pass_time();

  mutable std::mutex mutex_;
  std::unique_ptr<Board> board_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  bool plugged_ = true, held_ = false, open_ = false;
  int recovered_[3] = {};
};

}  // namespace fpga_stereo::sim
