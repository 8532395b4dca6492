// One board, from the moment its link is open: identified, configured, streaming, watched. A
// session handles bytes and time. It has neither threads nor transports (see device.hpp) and is not
// thread-safe.
//
// The parts: RequestQueue asks one thing at a time, Configurator decides what is asked, Receiver
// turns packets into frame sets, Watchdog decides when the link needs recovery. The session feeds
// them, keeps the state (state_machine.hpp), and handles their failures.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/link_state.hpp"
#include "fpga_stereo/link/session_options.hpp"
#include "link/configurator.hpp"
#include "link/decoder.hpp"
#include "link/outbox.hpp"
#include "link/receiver.hpp"
#include "link/request_queue.hpp"
#include "link/state_machine.hpp"
#include "link/watchdog.hpp"

namespace fpga_stereo::link {

class Session {
 public:
  using Clock = link::Clock;
  using Time = link::Time;
  using OnResult = RequestQueue::OnResult;

  Session() : Session(SessionOptions{}) {}
  explicit Session(const SessionOptions& options);

  /// The transport was opened: starts with a new board.
  void opened(Time now);
  /// The transport was lost.
  void closed();

  /// Sets what the board should do. Frames of the old state may still arrive, with its tag.
  void set_desired_state(const DesiredState& desired);

  /// Takes bytes that arrived. `wall`: the host's time of day, s.
  void receive(const std::uint8_t* bytes, std::size_t size, Time now, double wall);
  /// Advances time. Call at least every 20 ms.
  void tick(Time now, double wall);
  /// Bytes to be sent. The caller takes them out and reports with sent() what the transport
  /// accepts.
  std::vector<std::uint8_t>& outgoing() { return outbox_->bytes(); }
  /// Reports that the transport accepted this many more bytes. `began`: when it began to.
  void sent(std::size_t bytes, Time now, Time began);

  /// Returns the step that the watchdog asks for, once.
  std::optional<WatchdogStep> take_step();
  std::vector<ReceivedFrames> take_received();
  /// Returns messages for people, each once: frames dropped, failures, steps of the watchdog.
  std::vector<std::string> take_notes();

  /// Sends a request of a user between those of the session. `on_result` is called exactly once, at
  /// once if the link is closed.
  void ask(Request request, OnResult on_result);

  /// Sends a pair to a board whose pairs come from the host. Returns false, without sending it,
  /// while the transport has not accepted all of the last pair.
  bool send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                 std::uint64_t timestamp);

  LinkState state() const { return state_; }
  /// Returns why there are no frames; kNone if there are.
  LinkTrouble trouble() const;
  /// Returns the same for people; empty for kNone.
  std::string trouble_text() const;
  const std::optional<Identity>& identity() const { return configurator_->identity(); }
  /// The tag of the board's configuration; nullopt while another one is being applied.
  std::optional<std::uint64_t> active_tag() const { return configurator_->active_tag(); }
  const BoardCounters& board() const { return board_; }
  SessionCounters counters() const;
  const DecoderCounters& line() const { return decoder_.counters(); }
  const FrameCounters& frames() const { return receiver_.frame_counters(); }
  const TimeSync& clock() const { return receiver_.clock(); }

 private:
  void enter(LinkEvent event);
  void restart();
  void fail(const Error& error);
  void step(const Trouble& trouble);
  void take(const Packet& packet);
  void take_answer(const Packet& packet);
  /// Checks that the board's clock does not run backwards, as a reset makes it.
  Status check_clock(std::uint64_t board_time);
  void advance();
  void poll();
  Status take_poll(const RequestQueue::Values& values);
  /// Adds what the board has counted since the last poll.
  void count_up(const BoardCounters& now);
  void deliver();
  void flush();
  void read_clocks(Time now, double wall);
  /// Returns how many pairs the board takes for one frame set that it sends.
  int frame_interval() const;
  Receiver::Context context() const;

  SessionOptions options_;
  LinkState state_ = LinkState::kClosed;
  // On the heap, because the callbacks of requests point to them while a session is moved.
  std::unique_ptr<Outbox> outbox_;
  std::unique_ptr<RequestQueue> requests_;
  std::unique_ptr<Configurator> configurator_;
  Decoder decoder_;
  Receiver receiver_;
  Watchdog watchdog_;

  int failures_ = 0;                     // since the board was last in its desired state
  Error refusal_;                        // why the board is refused
  BoardCounters board_;                  // counted up
  std::optional<BoardCounters> polled_;  // the board's own, as last polled
  std::vector<std::string> notes_;
  std::optional<WatchdogStep> step_;
  std::optional<std::uint64_t> board_time_;  // us: when the board sent its last answer
  std::uint64_t pair_end_ = 0;               // Outbox::queued() after the last pair
  HostClock host_;
  Time now_{}, last_byte_{}, next_poll_{}, next_retry_{};
};

}  // namespace fpga_stereo::link
