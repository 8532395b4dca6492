// Counters of a link, for status reports.
#pragma once

#include <array>
#include <cstdint>

#include "fpga_stereo/link/link_state.hpp"

namespace fpga_stereo::link {

/// Counters that the board keeps, polled twice a second. They count what happened since the
/// session's construction while a board was configured, not since the board's power-on: until its
/// host configures it, a board counts every frame of its cameras as bad.
struct BoardCounters {
  std::uint32_t errors = 0;  // register ERRORS, as last polled
  std::uint32_t frames_in = 0, frames_out = 0, cut_frames = 0, long_frames = 0;
  std::uint32_t buffer_errors = 0, frames_dropped = 0, bad_packets = 0, lost_packets = 0;
  std::uint32_t input_errors = 0;
};

/// Counters of a session since its construction.
struct SessionCounters {
  std::uint64_t requests = 0;                // sent, without retries
  std::uint64_t retries = 0;                 // requests sent again because no answer came
  std::uint64_t configurations = 0;          // configurations that took effect
  std::uint64_t unknown_configurations = 0;  // frame sets dropped: made by an unknown configuration
  std::array<std::uint64_t, kNumWatchdogSteps> steps{};  // by WatchdogStep
};

/// Counters of a decoder since its construction.
struct DecoderCounters {
  std::uint64_t bytes = 0;          // given
  std::uint64_t packets = 0;        // intact
  std::uint64_t skipped_bytes = 0;  // that belong to no intact packet
  std::uint64_t bad_headers = 0;    // sync words followed by a wrong CRC or length
  std::uint64_t bad_payloads = 0;   // intact headers followed by a wrong or cut payload
  std::uint64_t lost_packets = 0;   // gaps in the sequence numbers
};

/// Counters of a frame assembler since its construction.
struct FrameCounters {
  std::uint64_t good = 0, dropped = 0, incomplete = 0;  // frames
  std::uint64_t refused_packets = 0;  // no frame is in flight for them, or their contents are wrong
};

}  // namespace fpga_stereo::link
