// A board on a link: found, opened, configured, and opened again whenever it comes back.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/link_state.hpp"
#include "fpga_stereo/link/session_options.hpp"
#include "fpga_stereo/link/transport.hpp"

namespace fpga_stereo::link {

/// A device has two threads. The link thread moves bytes and keeps the session with the board; the
/// delivery thread calls the callbacks, so that a slow callback does not hold up the link. Between
/// them is a bounded queue: if callbacks are too slow, the oldest frame sets are dropped and
/// counted.
///
/// All member functions may be called from any thread.
class Device {
 public:
  struct Options {
    Opener open;                             // opens the transport; called from the link thread
    std::shared_ptr<HotplugWatch> hotplug;   // signals that the board may have come; may be null
    std::chrono::milliseconds retry{500};    // the longest pause between two attempts to open
    std::size_t max_waiting_frame_sets = 8;  // in the queue, before the oldest is dropped
    SessionOptions session;
    std::function<double()> host_clock;  // s; default: the system clock
  };

  /// Called from the delivery thread, one at a time, in the order of the events. A callback may
  /// call all member functions; it must not destroy the device. Null callbacks are skipped.
  struct Callbacks {
    std::function<void(ReceivedFrames)> received;
    /// A board was identified: call set_desired_state() with a configuration for its build.
    std::function<void(const Identity&)> identified;
    /// The link was closed: frames in flight will not come.
    std::function<void()> closed;
    /// A message for people: what was opened, dropped, or has failed.
    std::function<void(const std::string&)> note;
  };

  struct Snapshot {
    LinkState state = LinkState::kClosed;
    LinkTrouble trouble = LinkTrouble::kNotOpened;  // why there are no frames; kNone if there are
    std::string trouble_text;                       // the same for people; empty for kNone
    std::string description;                        // of the transport; empty while closed
    std::optional<Identity> identity;               // of the board that answered
    std::optional<std::uint64_t> active_tag;        // of the board's configuration
    BoardCounters board;
    SessionCounters session;
    DecoderCounters decoder;
    FrameCounters frames;
    Transport::Counters transport;   // of all transports opened
    std::uint64_t times_opened = 0;  // transports opened
    std::uint64_t undelivered = 0;   // frame sets dropped because the callbacks were too slow
    double clock_drift = 0;          // s per s: how much faster the board's clock runs
    double clock_uncertainty = 0;    // s: error bound of stamps
  };

  Device(Options options, Callbacks callbacks);
  /// Turns the streams off, waits up to half a second for the board to confirm, and closes the
  /// link. Waits for the callback that is running; frame sets that wait are discarded.
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  /// Sets what the board should do, now and whenever it comes back.
  void set_desired_state(const DesiredState& desired);
  /// Sends a pair to a board whose pairs come from the host (DesiredState::host_input). Returns
  /// false, without sending it, if the board is not streaming or the transport has not accepted all
  /// of the last pair.
  bool send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                 std::uint64_t timestamp);
  /// Reads registers at these word addresses, in this order. Blocks until the board answers, the
  /// request times out, or the link is closed.
  Result<std::vector<RegisterWrite>> read_registers(const std::vector<std::uint32_t>& addresses);
  /// Writes registers in this order; blocks as read_registers() does.
  Status write_registers(const std::vector<RegisterWrite>& writes);
  /// Resets the device behind the transport, as the last step of the watchdog does.
  void reset();
  Snapshot snapshot() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fpga_stereo::link
