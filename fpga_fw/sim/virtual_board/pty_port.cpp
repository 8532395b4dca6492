#include "sim/virtual_board/pty_port.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>
#include <utility>

namespace fpga_stereo::sim {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr std::size_t kChunk = 65536;
constexpr milliseconds kHostPollPeriod{10};  // while no host has opened the path
constexpr milliseconds kBusyPeriod{1};       // while the board is too busy to take bytes

std::runtime_error failure(const std::string& what) {
  return std::runtime_error(what + ": " + std::strerror(errno));
}

/// Sets the line to raw mode. Opens and closes the slave once, because only then does poll() report
/// that no host is connected.
void prepare(const char* slave) {
  const int line = open(slave, O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (line < 0 || tcgetattr(line, &settings) != 0) throw failure(slave);
  cfmakeraw(&settings);
  tcsetattr(line, TCSANOW, &settings);
  close(line);
}

}  // namespace

PtyPort::PtyPort(std::string path) : path_(std::move(path)) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(path_, error)) && !fs::is_symlink(path_)) {
    throw std::runtime_error(path_ + ": exists and is not a symbolic link");
  }
}

PtyPort::~PtyPort() { close_line(); }

void PtyPort::close_line() {
  if (master_ < 0) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
  close(master_);
  master_ = -1;
}

void PtyPort::plug(bool plugged) {
  if (plugged == is_plugged()) return;
  from_host_.clear();
  to_host_.clear();
  if (!plugged) return close_line();
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> name{};
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, name.data(), name.size()) != 0) {
    throw failure("cannot create a pseudo terminal");
  }
  prepare(name.data());
  // Rename is atomic: a host never finds a partial link.
  const std::string new_path = path_ + ".new";
  std::error_code error;
  fs::remove(new_path, error);
  fs::create_symlink(name.data(), new_path, error);
  if (!error) fs::rename(new_path, path_, error);
  if (error) throw std::runtime_error(path_ + ": cannot be created: " + error.message());
}

bool PtyPort::has_host() const {
  if (!is_plugged()) return false;
  pollfd line{master_, POLLIN, 0};
  poll(&line, 1, 0);
  return (line.revents & POLLHUP) == 0;
}

bool PtyPort::move(Board& board) {
  if (!is_plugged()) return false;
  const bool has_host = this->has_host();
  const bool moved = move_from_host(board);
  if (has_host) return move_to_host(board) || moved;
  to_host_.clear();
  return moved;
}

bool PtyPort::move_from_host(Board& board) {
  if (from_host_.empty()) {
    from_host_.resize(kChunk);
    const ssize_t got = read(master_, from_host_.data(), from_host_.size());
    from_host_.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  }
  if (from_host_.empty()) return false;
  const std::size_t taken = board.receive(from_host_.data(), from_host_.size());
  from_host_.erase(from_host_.begin(), from_host_.begin() + static_cast<std::ptrdiff_t>(taken));
  return taken > 0;
}

bool PtyPort::move_to_host(Board& board) {
  if (to_host_.empty()) {
    to_host_.resize(kChunk);
    to_host_.resize(board.transmit(to_host_.data(), to_host_.size()));
  }
  if (to_host_.empty()) return false;
  const ssize_t went = write(master_, to_host_.data(), to_host_.size());
  if (went <= 0) return false;
  to_host_.erase(to_host_.begin(), to_host_.begin() + went);
  return true;
}

void PtyPort::wait(milliseconds timeout) const {
  // Without a host, poll() would return at once with a hang-up.
  if (!has_host()) return std::this_thread::sleep_for(std::min(timeout, kHostPollPeriod));
  pollfd line{master_, 0, 0};
  if (from_host_.empty()) line.events |= POLLIN;
  if (!to_host_.empty()) line.events |= POLLOUT;
  const bool is_board_busy = !from_host_.empty();
  poll(&line, 1,
       static_cast<int>((is_board_busy ? std::min(timeout, kBusyPeriod) : timeout).count()));
}

}  // namespace fpga_stereo::sim
