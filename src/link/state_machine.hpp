// The states of a session and the transitions between them. README.md beside this file draws the
// same table.
#pragma once

#include <optional>

#include "fpga_stereo/link/link_state.hpp"

namespace fpga_stereo::link {

enum class LinkEvent {
  kOpened,      // the transport is open; the board is asked what it is
  kClosed,      // the transport is closed
  kIdentified,  // the board is one that this software works with
  kRestarted,   // the board is identified again: after a failure, a reset or a watchdog step
  kRefused,     // the board is incompatible, or a failure has repeated too often
  kStreamsOff,  // configured, and no stream is wanted
  kStreamsOn,   // configured, and the streams are on
};
constexpr int kNumLinkEvents = 7;
/// Returns "opened", "closed", ...
const char* name(LinkEvent event);

struct LinkTransition {
  LinkState from;
  LinkEvent event;
  LinkState to;
};

constexpr LinkTransition kLinkTransitions[] = {
    {LinkState::kClosed, LinkEvent::kOpened, LinkState::kIdentifying},
    {LinkState::kIdentifying, LinkEvent::kIdentified, LinkState::kConfiguring},
    {LinkState::kConfiguring, LinkEvent::kStreamsOff, LinkState::kReady},
    {LinkState::kConfiguring, LinkEvent::kStreamsOn, LinkState::kStreaming},
    {LinkState::kReady, LinkEvent::kStreamsOff, LinkState::kReady},
    {LinkState::kReady, LinkEvent::kStreamsOn, LinkState::kStreaming},
    {LinkState::kStreaming, LinkEvent::kStreamsOff, LinkState::kReady},
    {LinkState::kStreaming, LinkEvent::kStreamsOn, LinkState::kStreaming},

    {LinkState::kIdentifying, LinkEvent::kRestarted, LinkState::kIdentifying},
    {LinkState::kConfiguring, LinkEvent::kRestarted, LinkState::kIdentifying},
    {LinkState::kReady, LinkEvent::kRestarted, LinkState::kIdentifying},
    {LinkState::kStreaming, LinkEvent::kRestarted, LinkState::kIdentifying},
    {LinkState::kRefused, LinkEvent::kRestarted, LinkState::kIdentifying},

    {LinkState::kIdentifying, LinkEvent::kRefused, LinkState::kRefused},
    {LinkState::kConfiguring, LinkEvent::kRefused, LinkState::kRefused},
    {LinkState::kReady, LinkEvent::kRefused, LinkState::kRefused},
    {LinkState::kStreaming, LinkEvent::kRefused, LinkState::kRefused},
    {LinkState::kRefused, LinkEvent::kRefused, LinkState::kRefused},

    {LinkState::kClosed, LinkEvent::kClosed, LinkState::kClosed},
    {LinkState::kIdentifying, LinkEvent::kClosed, LinkState::kClosed},
    {LinkState::kConfiguring, LinkEvent::kClosed, LinkState::kClosed},
    {LinkState::kReady, LinkEvent::kClosed, LinkState::kClosed},
    {LinkState::kStreaming, LinkEvent::kClosed, LinkState::kClosed},
    {LinkState::kRefused, LinkEvent::kClosed, LinkState::kClosed},
};

/// Returns the state after an event; nullopt if the table does not allow the event in this state.
constexpr std::optional<LinkState> next_state(LinkState from, LinkEvent event) {
  for (const LinkTransition& transition : kLinkTransitions) {
    if (transition.from == from && transition.event == event) return transition.to;
  }
  return std::nullopt;
}

}  // namespace fpga_stereo::link
