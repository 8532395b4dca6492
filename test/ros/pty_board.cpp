#include "ros/pty_board.hpp"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>

namespace fpga_stereo::test {

using Clock = std::chrono::steady_clock;

PtyBoard::PtyBoard(const std::string& path, const sim::SoftwareBoard::Options& options)
    : PtyBoard(path, std::make_unique<sim::SoftwareBoard>(options)) {}

PtyBoard::PtyBoard(std::string path, std::unique_ptr<sim::Board> board)
    : path_(std::move(path)),
      board_(std::move(board)),
      software_(dynamic_cast<sim::SoftwareBoard*>(board_.get())) {
  open_line();
  thread_ = std::thread([this] { run(); });
}

PtyBoard::~PtyBoard() {
  stop_ = true;
  thread_.join();
  close_line();
}

void PtyBoard::open_line() {
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0) {
    throw std::runtime_error("no pseudo terminal");
  }
  termios settings{};
  tcgetattr(master_, &settings);
  cfmakeraw(&settings);
  tcsetattr(master_, TCSANOW, &settings);
  unlink(path_.c_str());
  if (symlink(ptsname(master_), path_.c_str()) != 0) throw std::runtime_error("no link " + path_);
}

void PtyBoard::close_line() {
  if (master_ < 0) return;
  unlink(path_.c_str());
  close(master_);
  master_ = -1;
}

void PtyBoard::plug(bool plugged) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (plugged == (master_ >= 0)) return;
  if (plugged) {
    open_line();
  } else {
    close_line();
    in_.clear();
    out_.clear();
  }
}

void PtyBoard::watch(const sim::RawPair& pair, double rate) {
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

bool PtyBoard::move_bytes() {
  if (master_ < 0) return false;
  std::uint8_t bytes[4096];
  bool moved = false;
  if (in_.empty()) {
    const ssize_t n = read(master_, bytes, sizeof bytes);
    if (n > 0) in_.assign(bytes, bytes + n);
  }
  if (!in_.empty()) {
    const std::size_t taken = board_->from_host(in_.data(), in_.size());
    in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(taken));
    moved = taken > 0;
  }
  if (out_.empty()) {
    out_.resize(65536);
    out_.resize(board_->to_host(out_.data(), out_.size()));
  }
  if (out_.empty()) return moved;
  if (const ssize_t n = write(master_, out_.data(), out_.size()); n > 0) {
    out_.erase(out_.begin(), out_.begin() + n);
    moved = true;
  }
  return moved;
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
      for (int i = 0; i < 64 && move_bytes(); ++i) moved = true;
    }
    if (!moved) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace fpga_stereo::test
