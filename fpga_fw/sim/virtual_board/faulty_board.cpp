#include "sim/virtual_board/faulty_board.hpp"

#include <algorithm>

namespace fpga_stereo::sim {
namespace {

using std::chrono::microseconds;

constexpr microseconds kSilence{20000};  // after which an incomplete packet is passed on
constexpr microseconds kResetDelay{1000000};
constexpr std::size_t kMaxPendingBytes = 65536;  // from the host
constexpr double kMaxBurst = 0.02;               // s of allowance that can accumulate
constexpr std::size_t kDiscardBytes = 65536;     // per read

}  // namespace

FaultyBoard::FaultyBoard(std::unique_ptr<Board> board, const Options& options)
    : board_(std::move(board)),
      options_(options),
      to_host_(options.to_host, 2 * options.seed),
      from_host_(options.from_host, 2 * options.seed + 1) {}

void FaultyBoard::reset() {
  const std::lock_guard lock(mutex_);
  reset_board();
}

void FaultyBoard::reset_board() {
  board_->reset();
  reset_in_ = microseconds{0};
  ++counts_.resets;
}

std::size_t FaultyBoard::receive(const std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (is_stalled() || in_.size() > kMaxPendingBytes) return 0;
  silence_in_ = microseconds{0};
  from_host_.push(bytes, size, in_);
  counts_.from_host += size;
  deliver();
  return size;
}

void FaultyBoard::deliver() {
  if (in_.empty()) return;
  const std::size_t taken = board_->receive(in_.data(), in_.size());
  in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(taken));
}

std::size_t FaultyBoard::transmit(std::uint8_t* bytes, std::size_t size) {
  const std::lock_guard lock(mutex_);
  if (is_stalled()) return 0;
  if (options_.bytes_per_s > 0) size = std::min(size, static_cast<std::size_t>(allowance_));
  while (out_.size() - out_at_ < size) {
    if (fetch(size - (out_.size() - out_at_)) == 0) break;
  }
  const std::size_t part = std::min(size, out_.size() - out_at_);
  std::copy_n(out_.data() + out_at_, part, bytes);
  out_at_ += part;
  if (out_at_ == out_.size()) {
    out_.clear();
    out_at_ = 0;
  }
  allowance_ -= static_cast<double>(part);
  counts_.to_host += part;
  return part;
}

/// Moves up to `size` bytes from the board through the fault injector. Returns how many came.
std::size_t FaultyBoard::fetch(std::size_t size) {
  std::vector<std::uint8_t> bytes(size);
  std::size_t came = board_->transmit(bytes.data(), bytes.size());
  if (came == 0) return 0;
  silence_out_ = microseconds{0};
  if (reset_in_.count() > 0) {
    came = (came + 1) / 2;
    reset_board();
  }
  to_host_.push(bytes.data(), came, out_);
  return came;
}

void FaultyBoard::feed(const GreyPair& pair) {
  const std::lock_guard lock(mutex_);
  ++counts_.pairs;
  board_->feed(pair);
}

void FaultyBoard::run(microseconds time) {
  const std::lock_guard lock(mutex_);
  board_->run(time);
  stall_time_ = std::max(stall_time_ - time, microseconds{0});
  if (options_.bytes_per_s > 0) {
    const double seconds = std::chrono::duration<double>(time).count();
    allowance_ = std::min(allowance_ + options_.bytes_per_s * seconds,
                          std::max(options_.bytes_per_s * kMaxBurst, 1.0));
  }
  silence_out_ += time;
  silence_in_ += time;
  if (silence_out_ >= kSilence) to_host_.flush(out_);
  if (silence_in_ >= kSilence) from_host_.flush(in_);
  if (!is_stalled()) deliver();
  if (reset_in_.count() > 0 && (reset_in_ -= time).count() <= 0) reset_board();
}

void FaultyBoard::inject(bool to_host, LineFault fault, int count) {
  const std::lock_guard lock(mutex_);
  (to_host ? to_host_ : from_host_).inject(fault, count);
}

void FaultyBoard::stall(microseconds time) {
  const std::lock_guard lock(mutex_);
  stall_time_ = time;
  ++counts_.stalls;
}

void FaultyBoard::reset_soon() {
  const std::lock_guard lock(mutex_);
  reset_in_ = kResetDelay;
}

void FaultyBoard::discard() {
  const std::lock_guard lock(mutex_);
  counts_.lost += out_.size() - out_at_;
  out_.clear();
  out_at_ = 0;
  to_host_.clear();
  std::vector<std::uint8_t> bytes(kDiscardBytes);
  while (const std::size_t came = board_->transmit(bytes.data(), bytes.size()))
    counts_.lost += came;
}

void FaultyBoard::cut() {
  discard();
  const std::lock_guard lock(mutex_);
  in_.clear();
  from_host_.clear();
}

FaultyBoard::Counts FaultyBoard::counts() const {
  const std::lock_guard lock(mutex_);
  Counts counts = counts_;
  counts.faults_to_host = to_host_.counts();
  counts.faults_from_host = from_host_.counts();
  return counts;
}

}  // namespace fpga_stereo::sim
