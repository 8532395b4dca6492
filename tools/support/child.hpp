// Runs another program without a shell.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

class Child {
 public:
  /// Starts `command`, found in PATH, with additional environment variables ("NAME=VALUE"). Throws
  /// std::runtime_error, with the message `missing` if the program does not exist.
  Child(const std::vector<std::string>& command, const std::vector<std::string>& environment,
        const std::string& missing);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  /// Terminates the program: SIGTERM, then SIGKILL after five seconds.
  ~Child();

  /// Returns the exit code, or 128 + signal; nullopt while the program runs.
  std::optional<int> exit_code();
  /// Blocks until the program has ended. Returns its exit code.
  int wait();
  void send_signal(int signal) const;

 private:
  std::optional<int> collect(int options);

  pid_t pid_ = 0;
  std::optional<int> code_;
};

}  // namespace fpga_stereo::tools
