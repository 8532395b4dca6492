// Another program, started without a shell.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

class Child {
 public:
  /// Starts `command` (found by PATH), with these "NAME=VALUE" besides the environment. Throws
  /// std::runtime_error; `missing` is the message where there is no such program.
  Child(const std::vector<std::string>& command, const std::vector<std::string>& environment,
        const std::string& missing);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  /// Ends it: asks first, forces after five seconds.
  ~Child();

  /// Exit code (128 + signal) once it has ended.
  std::optional<int> exit_code();
  int wait();
  void send_signal(int signal) const;

 private:
  std::optional<int> collect(int options);

  pid_t pid_ = 0;
  std::optional<int> code_;
};

}  // namespace fpga_stereo::tools
