#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <thread>

#include "support/program.hpp"
#include "virtual_board/line.hpp"

namespace fpga_stereo::tools {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr std::size_t kChunk = 65536;
constexpr milliseconds kLookOut{10};  // how often it is looked whether somebody has opened it
constexpr milliseconds kBusy{1};      // while the board has bytes that nothing tells of

class PtyLine final : public Line {
 public:
  PtyLine(sim::FaultyBoard& board, std::string path) : board_(board), path_(std::move(path)) {
    std::error_code error;
    if (fs::exists(fs::symlink_status(path_, error)) && !fs::is_symlink(path_)) {
      throw std::runtime_error(path_ + ": is there already, and no symbolic link");
    }
    plug(true);
  }
  ~PtyLine() override { close_line(); }
  PtyLine(const PtyLine&) = delete;
  PtyLine& operator=(const PtyLine&) = delete;

  void plug(bool plugged) override;
  void serve(milliseconds most) override;
  std::string ready() const override { return path_; }

 private:
  void close_line();
  bool read_host();
  bool write_host();

  sim::FaultyBoard& board_;
  const std::string path_;
  int master_ = -1;
  std::vector<std::uint8_t> from_host_, to_host_;  // that have not gone on yet
};

std::runtime_error failure(const std::string& what) {
  return std::runtime_error(what + ": " + std::strerror(errno));
}

void PtyLine::close_line() {
  if (master_ < 0) return;
  std::error_code ignored;
  fs::remove(path_, ignored);
  close(master_);
  master_ = -1;
}

void PtyLine::plug(bool plugged) {
  if (plugged == (master_ >= 0)) return;
  from_host_.clear();
  to_host_.clear();
  if (!plugged) {
    close_line();
    return board_.cut();
  }
  master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> name{};
  if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
      ptsname_r(master_, name.data(), name.size()) != 0) {
    throw failure("a pseudo terminal cannot be made");
  }
  // Raw from the start, and once closed: only then the other side is known to be absent.
  const int slave = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  termios settings{};
  if (slave < 0 || tcgetattr(slave, &settings) != 0) throw failure(name.data());
  cfmakeraw(&settings);
  tcsetattr(slave, TCSANOW, &settings);
  close(slave);
  // In one step: whoever looks for the path never finds half of it.
  const std::string made = path_ + ".new";
  std::error_code error;
  fs::remove(made, error);
  fs::create_symlink(name.data(), made, error);
  if (!error) fs::rename(made, path_, error);
  if (error) throw std::runtime_error(path_ + ": cannot be made: " + error.message());
}

bool PtyLine::read_host() {
  if (from_host_.empty()) {
    from_host_.resize(kChunk);
    const ssize_t got = read(master_, from_host_.data(), from_host_.size());
    from_host_.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  }
  if (from_host_.empty()) return false;
  const std::size_t taken = board_.from_host(from_host_.data(), from_host_.size());
  from_host_.erase(from_host_.begin(), from_host_.begin() + static_cast<std::ptrdiff_t>(taken));
  return taken > 0;
}

bool PtyLine::write_host() {
  if (to_host_.empty()) {
    to_host_.resize(kChunk);
    to_host_.resize(board_.to_host(to_host_.data(), to_host_.size()));
  }
  if (to_host_.empty()) return false;
  const ssize_t went = write(master_, to_host_.data(), to_host_.size());
  if (went <= 0) return false;
  to_host_.erase(to_host_.begin(), to_host_.begin() + went);
  return true;
}

void PtyLine::serve(milliseconds most) {
  if (master_ < 0) return std::this_thread::sleep_for(most);
  pollfd line{master_, POLLIN, 0};
  poll(&line, 1, 0);
  const bool listens = (line.revents & POLLHUP) == 0;
  bool moved = read_host();
  if (!listens) {
    to_host_.clear();
    board_.discard();
    // A hang-up is always ready: poll() would not wait.
    if (!moved) std::this_thread::sleep_for(std::min(most, kLookOut));
    return;
  }
  moved = write_host() || moved;
  if (moved) return;
  line.events = 0;
  if (from_host_.empty()) line.events |= POLLIN;
  if (!to_host_.empty()) line.events |= POLLOUT;
  const bool held = !from_host_.empty();  // by the board
  poll(&line, 1, static_cast<int>((held ? std::min(most, kBusy) : most).count()));
}

}  // namespace

std::unique_ptr<Line> make_pty_line(sim::FaultyBoard& board, const std::string& path) {
  return std::make_unique<PtyLine>(board, path);
}

}  // namespace fpga_stereo::tools
