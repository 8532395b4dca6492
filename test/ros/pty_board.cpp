#include "ros/pty_board.hpp"

#include <chrono>
#include <utility>

namespace fpga_stereo::test {

using Clock = std::chrono::steady_clock;

PtyBoard::PtyBoard(const std::string& path, const sim::SoftwareBoard::Options& options)
    : PtyBoard(path, std::make_unique<sim::SoftwareBoard>(options)) {}

PtyBoard::PtyBoard(const std::string& path, std::unique_ptr<sim::Board> board)
    : port_(path),
      board_(std::move(board)),
      software_(dynamic_cast<sim::SoftwareBoard*>(board_.get())) {
  port_.plug(true);
  thread_ = std::thread([this] { run(); });
}

PtyBoard::~PtyBoard() {
  stop_ = true;
  thread_.join();
}

void PtyBoard::plug(bool plugged) {
  const std::lock_guard<std::mutex> lock(mutex_);
  port_.plug(plugged);
}

void PtyBoard::hold(bool held) { held_ = held; }

void PtyBoard::watch(const sim::GreyPair& pair, double rate) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pair_ = pair;
  rate_ = rate;
}

std::uint32_t PtyBoard::peek(std::uint32_t address) {
  const std::lock_guard<std::mutex> lock(mutex_);
  return software_ != nullptr ? software_->peek(address) : 0;
}

void PtyBoard::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  board_->reset();
}

void PtyBoard::run() {
  auto last = Clock::now(), next_frame = last;
  while (!stop_) {
    bool moved = false;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const auto now = Clock::now();
      board_->run(std::chrono::duration_cast<std::chrono::microseconds>(now - last));
      last = now;
      if (!pair_.left.empty() && now >= next_frame) {
        next_frame = now + std::chrono::microseconds(static_cast<int>(1e6 / rate_));
        board_->feed(pair_);
      }
      for (int i = 0; i < 64 && !held_ && port_.move(*board_); ++i) moved = true;
    }
    if (!moved) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace fpga_stereo::test
