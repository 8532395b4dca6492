#include "support/child.hpp"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace fpga_stereo::tools {
namespace {

/// Returns the environment with `added`, which replaces variables of the same name.
std::vector<std::string> environment_with(const std::vector<std::string>& added) {
  std::vector<std::string> all = added;
  const auto name = [](const std::string& entry) { return entry.substr(0, entry.find('=')); };
  for (char** entry = environ; *entry != nullptr; ++entry) {
    bool replaced = false;
    for (const std::string& other : added) replaced |= name(other) == name(*entry);
    if (!replaced) all.emplace_back(*entry);
  }
  return all;
}

std::vector<char*> pointers(const std::vector<std::string>& texts) {
  std::vector<char*> all;
  all.reserve(texts.size() + 1);
  for (const std::string& text : texts) all.push_back(const_cast<char*>(text.c_str()));
  all.push_back(nullptr);
  return all;
}

}  // namespace

Child::Child(const std::vector<std::string>& command, const std::vector<std::string>& environment,
             const std::string& missing) {
  const std::vector<std::string> variables = environment_with(environment);
  // The child must not inherit ignored or handled signals.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t defaults;
  sigemptyset(&defaults);
  sigaddset(&defaults, SIGINT);
  sigaddset(&defaults, SIGTERM);
  sigaddset(&defaults, SIGPIPE);
  posix_spawnattr_setsigdefault(&attributes, &defaults);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  const int error = posix_spawnp(&pid_, command[0].c_str(), nullptr, &attributes,
                                 pointers(command).data(), pointers(variables).data());
  posix_spawnattr_destroy(&attributes);
  if (error == ENOENT) throw std::runtime_error(missing);
  if (error != 0) {
    throw std::runtime_error(command[0] + ": cannot be started: " + std::strerror(error));
  }
}

Child::~Child() {
  send_signal(SIGTERM);
  for (int tenth = 0; tenth < 50 && !exit_code(); ++tenth) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  send_signal(SIGKILL);
  wait();
}

std::optional<int> Child::collect(int options) {
  while (!code_) {
    int status = 0;
    const pid_t ended = waitpid(pid_, &status, options);
    if (ended == 0) break;
    if (ended < 0 && errno == EINTR) continue;
    code_ = ended < 0 ? 1 : WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  return code_;
}

std::optional<int> Child::exit_code() { return collect(WNOHANG); }

int Child::wait() { return *collect(0); }

void Child::send_signal(int signal) const {
  if (!code_) kill(pid_, signal);
}

}  // namespace fpga_stereo::tools
