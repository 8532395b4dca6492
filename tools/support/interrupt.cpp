#include "support/interrupt.hpp"

#include <csignal>

namespace fpga_stereo::tools {
namespace {

volatile std::sig_atomic_t caught = 0;

void note_signal(int) { caught = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = note_signal;
  // Without SA_RESTART, blocking calls end at once. The second signal has its default effect.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return caught != 0; }

}  // namespace fpga_stereo::tools
