// A virtual board behind a pseudo terminal, for tests of the running node.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "sim/virtual_board/pty_port.hpp"
#include "sim/virtual_board/software_board.hpp"

namespace fpga_stereo::test {

class PtyBoard {
 public:
  /// Plugs the board in: `path` becomes a symbolic link to the pseudo terminal.
  PtyBoard(const std::string& path, std::unique_ptr<sim::Board> board);
  PtyBoard(const std::string& path, const sim::SoftwareBoard::Options& options);
  ~PtyBoard();

  void plug(bool plugged);
  /// While held, no byte passes the link.
  void hold(bool held);
  /// Makes its cameras see this pair `rate` times a second; an empty pair stops them.
  void watch(const sim::GreyPair& pair, double rate = 20);
  /// Reads a register of a software board; 0 from other boards.
  std::uint32_t peek(std::uint32_t address);
  void reset();

 private:
  void run();

  std::mutex mutex_;
  sim::PtyPort port_;
  const std::unique_ptr<sim::Board> board_;
  sim::SoftwareBoard* software_ = nullptr;
  sim::GreyPair pair_;
  double rate_ = 20;
  std::atomic<bool> stop_{false}, held_{false};
  std::thread thread_;
};

}  // namespace fpga_stereo::test
