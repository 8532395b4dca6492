#include "ros/board_log.hpp"

#include <ros/console.h>

#include <cctype>

namespace fpga_stereo {
namespace {

/// Returns the line without its numbers, decimal or hexadecimal.
std::string kind_of(const std::string& line) {
  const auto is = [](int (*test)(int), char c) { return test(static_cast<unsigned char>(c)) != 0; };
  std::string kind;
  bool is_number = false;
  for (const char c : line) {
    is_number = is(std::isdigit, c) || (is_number && is(std::isalnum, c));
    if (!is_number) kind += c;
  }
  return kind;
}

}  // namespace

std::optional<std::string> BoardLog::admit(const std::string& line) {
  const MutexLock lock(mutex_);
  const auto kept_back = limiter_.admit(kind_of(line));
  if (!kept_back) return std::nullopt;
  return with_kept_back(line, *kept_back);
}

void BoardLog::info(const std::string& line) {
  if (const auto admitted = admit(line)) ROS_INFO_STREAM_NAMED("stereo", *admitted);
}

void BoardLog::warn(const std::string& line) {
  if (const auto admitted = admit(line)) ROS_WARN_STREAM_NAMED("stereo", *admitted);
}

}  // namespace fpga_stereo
