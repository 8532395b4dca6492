#include "core/log_limiter.hpp"

#include <fmt/format.h>

#include <utility>

namespace fpga_stereo {
namespace {

constexpr std::string_view kOtherCauses;  // shared by the causes that find no place

}  // namespace

std::optional<std::uint64_t> LogLimiter::admit(std::string_view cause, Clock::time_point now) {
  if (causes_.size() >= kMaxCauses && causes_.find(cause) == causes_.end()) {
    forget_old_causes(now);
    if (causes_.size() >= kMaxCauses) cause = kOtherCauses;
  }
  const auto found = causes_.find(cause);
  if (found == causes_.end()) {
    causes_.emplace(cause, Cause{now});
    return 0;
  }
  Cause& known = found->second;
  if (now - known.admitted < kInterval) {
    ++known.kept_back;
    return std::nullopt;
  }
  known.admitted = now;
  return std::exchange(known.kept_back, 0);
}

void LogLimiter::forget_old_causes(Clock::time_point now) {
  for (auto cause = causes_.begin(); cause != causes_.end();) {
    const bool is_old = now - cause->second.admitted >= kInterval;
    cause = is_old ? causes_.erase(cause) : std::next(cause);
  }
}

std::string with_kept_back(const std::string& line, std::uint64_t kept_back) {
  if (kept_back == 0) return line;
  return fmt::format("{} ({} similar {} not logged)", line, kept_back,
                     kept_back == 1 ? "message was" : "messages were");
}

}  // namespace fpga_stereo
