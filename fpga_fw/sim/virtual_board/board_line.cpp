#include "sim/virtual_board/board_line.hpp"

#include <thread>

namespace fpga_stereo::sim {

using link::Recovery;
using link::Transport;

class BoardLine::Line : public Transport {
 public:
  explicit Line(BoardLine& owner) : owner_(owner) {}
  ~Line() override {
    const std::lock_guard<std::mutex> lock(owner_.mutex_);
    owner_.is_open_ = false;
  }
  Result<std::size_t> read(std::uint8_t* bytes, std::size_t size, Timeout timeout) override {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    while (true) {
      {
        const std::lock_guard<std::mutex> lock(owner_.mutex_);
        if (!owner_.is_plugged_) return gone();
        owner_.pass_time();
        const std::size_t n = owner_.is_held_ ? 0 : owner_.board_->transmit(bytes, size);
        counters_.bytes_in += n;
        if (n > 0 || std::chrono::steady_clock::now() >= deadline) return n;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  Result<std::size_t> write(const std::uint8_t* bytes, std::size_t size, Timeout timeout) override {
    if (timeout <= Timeout{0}) return std::size_t{0};  // USB would cancel the transfer
    const std::lock_guard<std::mutex> lock(owner_.mutex_);
    if (!owner_.is_plugged_) return gone();
    const std::size_t n = owner_.is_held_ ? size : owner_.board_->receive(bytes, size);
    counters_.bytes_out += n;
    return n;
  }
  Status recover(Recovery step) override {
    const std::lock_guard<std::mutex> lock(owner_.mutex_);
    ++owner_.recovered_[static_cast<std::size_t>(step)];
    return {};
  }
  std::string description() const override { return "virtual board in this process"; }
  Counters counters() const override { return counters_; }

 private:
  static Error gone() { return {ErrorKind::kUnplugged, "the board was unplugged"}; }

  BoardLine& owner_;
  Counters counters_;
};

Result<std::unique_ptr<Transport>> BoardLine::open() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!is_plugged_) return Error{ErrorKind::kNotFound, "no board is plugged in"};
  if (is_open_) return Error{ErrorKind::kBusy, "the board is in use"};
  is_open_ = true;
  return std::unique_ptr<Transport>(std::make_unique<Line>(*this));
}

void BoardLine::pass_time() {
  const auto now = std::chrono::steady_clock::now();
  const auto time = std::chrono::duration_cast<std::chrono::microseconds>(now - last_run_);
  last_run_ += time;
  board_->run(time);
}

void BoardLine::plug(bool is_plugged) {
  const std::lock_guard<std::mutex> lock(mutex_);
  is_plugged_ = is_plugged;
}

void BoardLine::hold(bool is_held) {
  const std::lock_guard<std::mutex> lock(mutex_);
  is_held_ = is_held;
}

void BoardLine::feed(const GreyPair& pair) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pass_time();
  board_->feed(pair);
}

void BoardLine::reset_board() {
  const std::lock_guard<std::mutex> lock(mutex_);
  board_->reset();
}

int BoardLine::recovered(Recovery step) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return recovered_[static_cast<std::size_t>(step)];
}

}  // namespace fpga_stereo::sim
