#include "link/time_sync.hpp"

#include <algorithm>
#include <cmath>

namespace fpga_stereo::link {

double TimeSync::since_reference(std::uint64_t board_us) const {
  // The board's clock may wrap.
  return static_cast<double>(static_cast<std::int64_t>(board_us - board_reference_)) * 1e-6;
}

bool TimeSync::add(double sent, std::uint64_t board_us, double received) {
  const double half = (received - sent) / 2;
  if (half < 0 || half > kMaxHalf) return false;
  if (samples_.empty()) {
    board_reference_ = board_us;
    host_reference_ = sent + half;
  }
  const Sample sample{since_reference(board_us), sent + half - host_reference_};
  if (!samples_.empty()) {
    const Sample& last = samples_.back();
    if (sample.board <= last.board) return false;
    const double passed = sample.host - last.host;
    const double error = sample.host - (offset_ + slope_ * sample.board);
    if (std::abs(error) > kMaxError + kMaxDrift * passed) {
      restart();
    } else {
      strikes_ = std::max(strikes_ - 1, 0);
    }
  }
  samples_.push_back(sample);
  if (samples_.size() > kMaxSamples) samples_.pop_front();
  shortest_half_ = std::min(shortest_half_, half);
  fit();
  return true;
}

void TimeSync::restart() {
  samples_.clear();
  has_last_ = false;
  ++steps_;
  strikes_ = std::min(strikes_ + kStrikesOfStep, kMaxStrikes + kStrikesOfStep);
}

void TimeSync::fit() {
  double board = 0, host = 0;
  for (const Sample& s : samples_) {
    board += s.board;
    host += s.host;
  }
  const auto n = static_cast<double>(samples_.size());
  board /= n;
  host /= n;
  double square = 0, product = 0;
  for (const Sample& s : samples_) {
    square += (s.board - board) * (s.board - board);
    product += (s.board - board) * (s.host - host);
  }
  // Over a short time the errors of the round trips exceed the drift.
  constexpr double kMinSpan = 5;  // s
  const bool is_short = samples_.back().board - samples_.front().board < kMinSpan;
  slope_ = is_short ? 1 : std::clamp(product / square, 1 - kMaxDrift, 1 + kMaxDrift);
  offset_ = host - slope_ * board;
}

std::optional<double> TimeSync::to_host(std::uint64_t board_us) {
  if (samples_.empty()) return std::nullopt;
  const double board = since_reference(board_us);
  double host = offset_ + slope_ * board;
  if (has_last_ && board >= last_board_) host = std::max(host, last_host_);
  if (!has_last_ || board > last_board_) {
    last_board_ = board;
    last_host_ = host;
    has_last_ = true;
  }
  return host_reference_ + host;
}

void TimeSync::reset() { *this = TimeSync(); }

}  // namespace fpga_stereo::link
