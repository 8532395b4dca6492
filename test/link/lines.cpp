#include "link/lines.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <ostream>
#include <stdexcept>

#include "link/serial.hpp"

namespace fpga_stereo::test {

void PrintTo(const LineKind& kind, std::ostream* out) { *out << kind.name; }

void Wire::push(const std::uint8_t* bytes, std::size_t size) {
  {
    const std::lock_guard lock(mutex_);
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ = 0;
    bytes_.insert(bytes_.end(), bytes, bytes + size);
  }
  changed_.notify_all();
}

std::size_t Wire::pop(std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard lock(mutex_);
  const std::size_t part = std::min(size, bytes_.size() - at_);
  std::copy_n(bytes_.data() + at_, part, bytes);
  at_ += part;
  return part;
}

Bytes Wire::wait(std::size_t size) {
  {
    std::unique_lock lock(mutex_);
    const auto there = [&] { return bytes_.size() - at_ >= size; };
    changed_.wait_for(lock, std::chrono::seconds(5), there);
  }
  Bytes taken(size);
  taken.resize(pop(taken.data(), size));
  return taken;
}

std::size_t Wire::size() const {
  const std::lock_guard lock(mutex_);
  return bytes_.size() - at_;
}

void Wire::clear() {
  const std::lock_guard lock(mutex_);
  bytes_.clear();
  at_ = 0;
}

namespace {

/// A transport over memory.
struct Memory {
  std::mutex mutex;
  std::condition_variable changed;
  Wire to_host, from_host;
  bool listening = true, plugged = true;
  int plugs = 1;

  template <class Action>
  void change(Action action) {
    const std::lock_guard lock(mutex);
    action();
    changed.notify_all();
  }
};

class MemoryTransport : public link::Transport {
 public:
  explicit MemoryTransport(std::shared_ptr<Memory> memory)
      : memory_(std::move(memory)), plug_(memory_->plugs) {}

  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override {
    std::unique_lock lock(memory_->mutex);
    std::size_t part = 0;
    memory_->changed.wait_for(
        lock, timeout, [&] { return gone() || (part = memory_->to_host.pop(bytes, size)) > 0; });
    if (gone()) return error();
    counters_.bytes_in += part;
    return part;
  }

  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override {
    std::unique_lock lock(memory_->mutex);
    memory_->changed.wait_for(lock, timeout, [&] { return gone() || memory_->listening; });
    if (gone()) return error();
    if (!memory_->listening) return std::size_t{0};
    memory_->from_host.push(bytes, size);
    counters_.bytes_out += size;
    return size;
  }

  Status recover(link::Recovery step) override {
    const std::lock_guard lock(memory_->mutex);
    if (gone()) return error();
    memory_->to_host.clear();
    reset_ = step == link::Recovery::kReset;
    return {};
  }
  std::string description() const override { return "memory"; }
  Counters counters() const override {
    const std::lock_guard lock(memory_->mutex);
    return counters_;
  }

 private:
  bool gone() const { return reset_ || !memory_->plugged || memory_->plugs != plug_; }
  static Error error() { return {ErrorKind::kUnplugged, "gone"}; }

  const std::shared_ptr<Memory> memory_;
  const int plug_;
  bool reset_ = false;
  Counters counters_;
};

class MemoryLine : public Line {
 public:
  Result<std::unique_ptr<link::Transport>> open() override {
    if (!memory_->plugged) return Error{ErrorKind::kNotFound, "unplugged"};
    return std::unique_ptr<link::Transport>(std::make_unique<MemoryTransport>(memory_));
  }
  void send(const Bytes& bytes) override {
    memory_->change([&] { memory_->to_host.push(bytes.data(), bytes.size()); });
  }
  Bytes take(std::size_t size) override { return memory_->from_host.wait(size); }
  void listen(bool on) override {
    memory_->change([&] { memory_->listening = on; });
  }
  void unplug() override {
    memory_->change([&] {
      memory_->plugged = false;
      memory_->to_host.clear();
    });
  }
  void plug() override {
    memory_->change([&] {
      memory_->plugged = true;
      ++memory_->plugs;
    });
  }

 private:
  std::shared_ptr<Memory> memory_ = std::make_shared<Memory>();
};

/// A serial line; the master of a pty is its far end.
class PtyLine : public Line {
 public:
  PtyLine() { plug(); }
  ~PtyLine() override { unplug(); }

  Result<std::unique_ptr<link::Transport>> open() override { return link::open_serial(path_); }
  void send(const Bytes& bytes) override { to_host_.push(bytes.data(), bytes.size()); }
  Bytes take(std::size_t size) override { return from_host_.wait(size); }
  void listen(bool on) override { listening_ = on; }

  void unplug() override {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    if (master_ >= 0) close(master_);
    master_ = -1;
    to_host_.clear();
  }
  void plug() override {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    std::array<char, 64> name{};
    if (master_ < 0 || grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name.data(), name.size()) != 0) {
      throw std::runtime_error("there is no pty");
    }
    path_ = name.data();
    stop_ = false;
    thread_ = std::thread([this] { run(); });
  }

 private:
  void run() {
    Bytes in(4096), out;
    while (!stop_) {
      bool idle = true;
      if (out.empty()) {
        out.resize(4096);
        out.resize(to_host_.pop(out.data(), out.size()));
      }
      const ssize_t went = out.empty() ? 0 : write(master_, out.data(), out.size());
      if (went > 0) {
        out.erase(out.begin(), out.begin() + went);
        idle = false;
      }
      const ssize_t got = listening_ ? read(master_, in.data(), in.size()) : 0;
      if (got > 0) {
        from_host_.push(in.data(), static_cast<std::size_t>(got));
        idle = false;
      }
      pollfd line{master_, static_cast<short>(listening_ ? POLLIN : 0), 0};
      if (idle) poll(&line, 1, 1);
    }
  }

  int master_ = -1;
  std::string path_;
  Wire to_host_, from_host_;
  std::atomic<bool> listening_{true}, stop_{false};
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Line> make_memory_line() { return std::make_unique<MemoryLine>(); }
std::unique_ptr<Line> make_pty_line() { return std::make_unique<PtyLine>(); }

}  // namespace fpga_stereo::test
