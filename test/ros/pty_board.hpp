// A board that is a program behind a serial line, for tests of the running node.
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
  /// Plugged in: `path` becomes a link to the pseudo terminal.
  PtyBoard(const std::string& path, std::unique_ptr<sim::Board> board);
  PtyBoard(const std::string& path, const sim::SoftwareBoard::Options& options);
  ~PtyBoard();

  void plug(bool plugged);
  /// While held, no byte goes over the line.
  void hold(bool held);
  /// Its cameras see this pair, `rate` times a second; an empty one: nothing.
  void watch(const sim::GreyPair& pair, double rate = 20);
  /// Of a board of software.
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
