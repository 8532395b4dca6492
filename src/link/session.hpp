// One board, from the moment its line is open: identified, configured, streaming, watched. Knows
// bytes and time, but neither threads nor transports: those are the device's (device.hpp).
//
//   closed -> identifying -> configuring -> ready (nothing is wanted) or streaming
//                         -> refused (another specification, or a setting that it does not hold,
//                            which is tried again now and then)
//   Whatever is lost on the way, the watchdog's steps lead back to identifying: purge, restart,
//   reopen, reset.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/link/counters.hpp"
#include "fpga_stereo/link/desired_state.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/link_state.hpp"
#include "fpga_stereo/link/session_options.hpp"
#include "link/decoder.hpp"
#include "link/frame_assembler.hpp"
#include "link/frame_set_collector.hpp"
#include "link/request.hpp"
#include "link/time_sync.hpp"

namespace fpga_stereo::link {

class Session {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  Session() : Session(SessionOptions{}) {}
  explicit Session(const SessionOptions& options) : options_(options) {}

  /// The line is open; everything begins anew.
  void opened(Time now);
  /// The line is lost.
  void closed();

  /// What the board is to do, from now on. Takes effect with a next frame.
  void set_desired_state(const DesiredState& desired);

  /// Bytes that came. `host` is the host's time of day, s, at which they did.
  void receive(const std::uint8_t* bytes, std::size_t size, Time now, double host);
  /// To be called again and again, at least each 20 ms.
  void tick(Time now, double host);
  /// Bytes to be sent; the caller takes them out, and says when they go.
  std::vector<std::uint8_t>& outgoing() { return outgoing_; }
  /// So many of those have been given to the line. `host`: s, when that began.
  void sent(std::size_t bytes, Time now, double host);

  /// The watchdog asks for this, once.
  std::optional<WatchdogStep> take_step();
  std::vector<ReceivedFrames> take_received();
  /// What was dropped without a set, or has gone wrong, once, for people.
  std::vector<std::string> take_notes();

  /// A request of somebody else's, between ours: the answer's values (of a read) or why there is
  /// none. Refused at once while the line is closed.
  using Answer = std::function<void(Result<std::vector<RegisterWrite>>)>;
  void ask(Request request, Answer answer);

  /// A pair for a board whose images come from the host. False: the line has not taken all of the
  /// one before, and this one is not sent.
  bool send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                 std::uint64_t timestamp);

  LinkState state() const { return state_; }
  /// Returns why there are no frames; kNone if there are.
  LinkTrouble trouble() const;
  /// Returns the same for people; empty if there are frames.
  std::string trouble_text() const;
  const std::optional<Identity>& identity() const { return identity_; }
  /// The tag of the configuration that the board has, once it has one of ours and no other waits.
  std::optional<std::uint64_t> configured() const;
  const BoardCounters& board() const { return board_; }
  const SessionCounters& counters() const { return counters_; }
  const DecoderCounters& line() const { return decoder_.counters(); }
  const FrameCounters& frames() const { return assembler_.counters(); }
  const TimeSync& clock() const { return clock_; }

 private:
  /// A request that waits, or is under way.
  struct Job {
    Request request;
    /// What is to come of the answer; a failure ends what the job was part of.
    std::function<Status(const std::vector<RegisterWrite>&)> done;
    Answer answer;  // of ask(); then `done` is empty
    Time not_before{};
  };
  struct InFlight {
    std::uint16_t id;
    int tries;
    double sent;        // host, s
    std::uint64_t end;  // of its bytes, among all that were ever queued
    Time deadline;      // of the answer: from when the line has taken them
  };

  using PairKey = std::pair<std::uint64_t, std::uint64_t>;   // frame_id, timestamp
  using Meshes = std::array<std::vector<std::uint32_t>, 2>;  // left, right
  static constexpr const char* kWasReset = "the board was reset";

  // session_jobs.cpp: what is asked, in which order.
  void identify();
  void configure();
  void write_back(const std::vector<RegisterWrite>& writes);
  void write_mesh(std::uint32_t right, const std::vector<std::uint32_t>& mesh);
  void await_apply(std::shared_ptr<const GatewareConfiguration> configuration);
  void set_streams();
  void poll();
  Status identified(const std::vector<RegisterWrite>& values);
  Status polled(const std::vector<RegisterWrite>& values);
  void begin(Request request, std::function<Status(const std::vector<RegisterWrite>&)> done);

  // session_receive.cpp: what comes.
  void take(const Packet& packet);
  void take_answer(const Packet& packet);
  /// The time of an answer: not behind that of the one before, or else the board was reset.
  Status check_clock(std::uint64_t board_time);
  /// Made of a pair that send_pair() has sent.
  bool is_hosts(const FrameSet& set) const;
  void deliver();

  // session.cpp
  void begin_anew();
  bool stalled() const;
  void start_jobs();
  void send_request();
  void failed(const Error& error);
  void watch();
  void step(LinkTrouble trouble, const std::string& why);
  void drop_jobs(const Error& error);
  void settle();

  SessionOptions options_;
  LinkState state_ = LinkState::kClosed;
  std::string refusal_;  // of the board, or of its settings
  ErrorKind refused_as_ = ErrorKind::kIo;
  LinkTrouble watchdog_trouble_ = LinkTrouble::kNone;  // what the watchdog acts upon
  std::string watchdog_text_;
  std::optional<Identity> identity_;
  BoardCounters board_;
  SessionCounters counters_;
  TimeSync clock_;

  Decoder decoder_;
  FrameAssembler assembler_;
  FrameSetCollector sets_;
  std::vector<AssembledFrame> assembled_;
  std::vector<FrameSet> complete_;
  std::vector<ReceivedFrames> received_;
  std::vector<std::string> notes_;
  std::vector<std::uint8_t> outgoing_;
  std::uint64_t queued_ = 0, sent_ = 0;  // bytes, since the line was opened
  std::uint64_t pair_end_ = 0;           // of the last pair, among those
  std::deque<PairKey> pairs_;            // that were sent, the last of them
  std::uint32_t sequence_ = kLinkFirstSequence;

  DesiredState desired_;
  bool configuration_stale_ = false;             // the board does not have desired_.configuration
  bool streams_stale_ = false;                   // nor the rest
  Meshes meshes_;                                // that the board has, if any
  std::map<std::uint32_t, std::uint64_t> tags_;  // from this configuration on
  std::uint32_t configuration_ = 0;              // of the board, as last read
  int attempts_ = 0;                             // to configure
  std::optional<std::uint64_t> board_time_;      // us: when the last answer was sent

  std::deque<Job> jobs_;
  std::optional<InFlight> in_flight_;
  std::uint16_t next_id_ = 0;
  double host_ = 0;  // s, the host's time of day at now_
  Time now_{}, next_poll_{}, last_packet_{}, next_step_{};
  Time last_byte_{}, apply_deadline_{};
  Time next_retry_{};
  Time last_frame_{};                 // when a part of one came, or was asked for
  bool frame_came_ = false;           // or a part of one, since the last poll
  bool unstamped_ = false;            // that frames have times of arrival was said
  std::uint32_t input_at_frame_ = 0;  // FRAMES_IN at the poll behind that
  int ladder_ = 0;
  std::optional<WatchdogStep> step_;
};

const char* name(LinkState state);
const char* name(WatchdogStep step);

}  // namespace fpga_stereo::link
