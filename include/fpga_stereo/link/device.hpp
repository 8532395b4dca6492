// A board on a line: found, opened, and opened again whenever it comes back. One thread of its own
// moves the bytes; what comes is handed on from that thread.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/link_state.hpp"
#include "fpga_stereo/link/transport.hpp"
#include "link/session.hpp"

namespace fpga_stereo::link {

class Device {
 public:
  struct Options {
    Opener open;                            // how the line is opened
    std::shared_ptr<HotplugWatch> hotplug;  // what tells that it may have come; may be null
    std::chrono::milliseconds retry{500};   // between two attempts to open, at most
    SessionOptions session;
    std::function<double()> host_clock;  // s; default: the system's clock
  };

  /// Called from the device's own thread. None may wait for another call of the device to end.
  struct Callbacks {
    std::function<void(std::vector<ReceivedFrames>)> received;
    /// A board was identified; want() is to be called with what suits its build.
    std::function<void(const Identity&)> identified;
    /// The line is closed; what was under way will not come.
    std::function<void()> closed;
    /// Something has happened that people should know.
    std::function<void(const std::string&)> note;
  };

  /// How things are.
  struct Snapshot {
    LinkState state = LinkState::kClosed;
    LinkTrouble trouble = LinkTrouble::kNotOpened;  // why there are no frames
    std::string trouble_text;                       // the same for people; empty for kNone
    std::string description;                        // of the line; empty: closed
    std::optional<Identity> identity;
    std::optional<std::uint64_t> active_tag;  // of what the board computes with
    BoardCounters board;
    SessionCounters session;
    DecoderCounters decoder;
    FrameCounters frames;
    Transport::Counters transport;
    std::uint64_t times_opened = 0;
    std::uint64_t undelivered = 0;  // frame sets dropped because the callbacks were too slow
    double clock_drift = 0;         // s per s
    double clock_uncertainty = 0;   // s
  };

  Device(Options options, Callbacks callbacks);
  /// Switches the streams off, waits half a second at most for the board to have done so, closes.
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void set_desired_state(const DesiredState& desired);
  /// See Session. False also where there is no board.
  bool send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                 std::uint64_t timestamp);
  /// Reads registers at these word addresses, in this order. Blocks until the board answers or is
  /// lost. Not to be called from a callback.
  Result<std::vector<RegisterWrite>> read_registers(const std::vector<std::uint32_t>& addresses);
  /// Writes registers in this order; blocks as read_registers() does.
  Status write_registers(const std::vector<RegisterWrite>& writes);
  /// Resets the board's line as the last step of the watchdog does.
  void reset();
  Snapshot snapshot() const;

 private:
  Result<std::vector<RegisterWrite>> ask(const Request& request);
  void run();
  /// Opens the line or waits; false: there is none.
  bool open();
  void wait_to_retry();
  void close(LinkTrouble trouble, const std::string& why);
  /// Bytes both ways, once. An error closes the line.
  Status exchange();
  void serve(WatchdogStep step);
  void hand_on();

  Options options_;
  Callbacks callbacks_;
  // Of the thread.
  std::unique_ptr<Transport> transport_;
  std::vector<std::uint8_t> in_, out_;
  std::size_t sent_ = 0;  // of out_
  bool told_identity_ = false;
  std::string open_error_;

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Session session_;
  std::string description_, closed_because_;
  LinkTrouble closed_trouble_ = LinkTrouble::kNotOpened;
  Transport::Counters transport_counters_;
  std::uint64_t opened_ = 0;
  bool stopping_ = false, reset_asked_ = false;

  std::thread thread_;
};

}  // namespace fpga_stereo::link
