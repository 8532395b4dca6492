// Keeps a fault that repeats from flooding a log.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace fpga_stereo {

/// Admits one line per cause and 10 s. A cause is a short name that the program chooses, such as
/// that of an enumerator. The text of the line does not count, because it may contain numbers that
/// change each time. Remembers 64 causes; any more within 10 s share one line. One thread at a
/// time.
class LogLimiter {
 public:
  using Clock = std::chrono::steady_clock;

  static constexpr std::chrono::seconds kInterval{10};
  static constexpr std::size_t kMaxCauses = 64;

  /// Returns how many lines of this cause were kept back since the last admitted one, or nullopt if
  /// this line must be kept back as well.
  std::optional<std::uint64_t> admit(std::string_view cause, Clock::time_point now = Clock::now());

 private:
  struct Cause {
    Clock::time_point admitted;  // its last line
    std::uint64_t kept_back = 0;
  };

  void forget_old_causes(Clock::time_point now);

  std::map<std::string, Cause, std::less<>> causes_;
};

/// Returns the line with a note about those that were kept back before it, if any.
std::string with_kept_back(const std::string& line, std::uint64_t kept_back);

}  // namespace fpga_stereo
