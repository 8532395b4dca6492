// The state of the link to a board, and why it brings no frames.
#pragma once

#include <array>

namespace fpga_stereo::link {

enum class LinkState {
  kClosed,       // no transport is open
  kIdentifying,  // the board is asked what it is
  kRefused,      // the board is incompatible, or does not hold its configuration
  kConfiguring,  // registers and meshes are written and read back
  kReady,        // configured; no stream is wanted
  kStreaming,    // configured; the board sends what is wanted
};
constexpr int kNumLinkStates = 6;
/// Returns "closed", "identifying", ...
const char* name(LinkState state);

/// Why the link brings no frames.
enum class LinkTrouble {
  kNone,
  // The link is closed.
  kNotOpened,   // no attempt to open a transport has been made yet
  kNoDevice,    // no such device
  kBusy,        // another program uses the device
  kPermission,  // the user may not open the device
  kUnplugged,   // the device was unplugged or lost its power
  kIo,          // the transport does not open, or failed
  kReopening,   // the watchdog or the user closed the link to open it again
  // The board is not configured yet.
  kIdentifying,     // the board is being identified
  kConfiguring,     // the configuration is being written
  kUnconfigurable,  // no configuration for this build has been given
  // The board is refused.
  kIncompatible,  // another version of protocol or gateware
  kRejected,      // the board rejects its configuration, or does not hold what is written
  // The watchdog is at work.
  kSilent,    // the board sends nothing, or does not answer
  kStalled,   // the board takes pairs but sends no good frames
  kNoImages,  // the board's cameras deliver no images
};

/// Steps of the watchdog, mild to harsh. The last one repeats.
enum class WatchdogStep { kPurge, kRestart, kReopen, kReset };
constexpr int kNumWatchdogSteps = 4;
/// Returns "purge", "restart", ...
const char* name(WatchdogStep step);

}  // namespace fpga_stereo::link
