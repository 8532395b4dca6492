#include "fpga_stereo/link/link_state.hpp"

#include <cstddef>

#include "link/state_machine.hpp"

namespace fpga_stereo::link {

const char* name(LinkState state) {
  static constexpr std::array<const char*, kNumLinkStates> kNames{
      "closed", "identifying", "refused", "configuring", "ready", "streaming"};
  return kNames[static_cast<std::size_t>(state)];
}

const char* name(WatchdogStep step) {
  static constexpr std::array<const char*, kNumWatchdogSteps> kNames{"purge", "restart", "reopen",
                                                                     "reset"};
  return kNames[static_cast<std::size_t>(step)];
}

const char* name(LinkEvent event) {
  static constexpr std::array<const char*, kNumLinkEvents> kNames{
      "opened", "closed", "identified", "restarted", "refused", "streams off", "streams on"};
  return kNames[static_cast<std::size_t>(event)];
}

}  // namespace fpga_stereo::link
