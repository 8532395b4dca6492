// Timing of a session with a board.
#pragma once

#include <chrono>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::link {

struct SessionOptions {
  std::chrono::milliseconds answer{250};  // timeout of a request
  int tries = 4;                          // of a request, the first one included
  /// In which the transport must accept a request; longer if bytes wait before it on a slow line.
  std::chrono::milliseconds accept{1000};
  std::chrono::milliseconds silence{3 * kHeartbeatMs};  // before the watchdog's first step
  std::chrono::milliseconds step{1000};                 // between two steps of the watchdog
  std::chrono::milliseconds poll{kHeartbeatMs};         // between two polls of the counters
  std::chrono::milliseconds retry{10000};               // before a rejected configuration is resent
  /// The link stalls if for `stall` no frame has come, and the board has taken `periods` pairs of
  /// which it should have sent the frames.
  int periods = 10;
  std::chrono::milliseconds stall{1000};
  /// Good frames are missing if none has come for this time, or for `periods` times the time
  /// between the last ones if that is longer; if others come, for `hopeless`.
  std::chrono::milliseconds missing{3000}, hopeless{60000};
  /// Delivers disparity frames that lack up to half of their rows; these hold no disparity.
  bool keep_incomplete = false;
};

}  // namespace fpga_stereo::link
