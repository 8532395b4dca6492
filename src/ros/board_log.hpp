// What is logged about a board.
#pragma once

#include <optional>
#include <string>

#include "core/log_limiter.hpp"
#include "core/thread_safety.hpp"

namespace fpga_stereo {

/// Logs lines about a board, one of a kind per 10 s: a board decides how often they come. Lines
/// that differ only in numbers are of one kind. Thread-safe; its lock is a leaf.
class BoardLog {
 public:
  void info(const std::string& line) FPGA_STEREO_EXCLUDES(mutex_);
  void warn(const std::string& line) FPGA_STEREO_EXCLUDES(mutex_);
  /// Returns the line as it is to be logged, or nullopt if it is kept back.
  std::optional<std::string> admit(const std::string& line) FPGA_STEREO_EXCLUDES(mutex_);

 private:
  Mutex mutex_;
  LogLimiter limiter_ FPGA_STEREO_GUARDED_BY(mutex_);
};

}  // namespace fpga_stereo
