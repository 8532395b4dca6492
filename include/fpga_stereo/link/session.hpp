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
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fpga_stereo/link/decoder.hpp"
#include "fpga_stereo/link/frame_assembler.hpp"
#include "fpga_stereo/link/frame_sets.hpp"
#include "fpga_stereo/link/identity.hpp"
#include "fpga_stereo/link/request.hpp"
#include "fpga_stereo/link/time_sync.hpp"

namespace fpga_stereo::link {

/// What a board is to do.
struct Wanted {
  /// For the build of the board that was identified. Without one that is, no frame comes.
  std::optional<GatewareConfiguration> configuration;
  /// Instead: none is written, and frames of whatever configuration the board has are taken.
  bool as_it_is = false;
  /// Comes back with every frame that this configuration made.
  std::uint64_t tag = 0;
  unsigned streams = 0;                       // bit s: stream s is sent
  int frame_interval = 1;                     // one pair in so many is sent
  int raw_interval = 1;                       // raw images: one in so many of those
  bool host_input = false;                    // pairs come from the host, not from cameras
  std::chrono::microseconds mid_exposure{0};  // from there to the first pixel
};

/// What a board says about itself, every half second.
struct BoardCounters {
  std::uint32_t errors = 0;  // register ERRORS
  std::uint32_t frames_in = 0, frames_out = 0, cut_frames = 0, long_frames = 0;
  std::uint32_t buffer_errors = 0, frames_dropped = 0, bad_packets = 0, lost_packets = 0;
  std::uint32_t input_errors = 0;
};

class Session {
 public:
  using Clock = std::chrono::steady_clock;
  using Time = Clock::time_point;

  enum class State { kClosed, kIdentifying, kRefused, kConfiguring, kReady, kStreaming };

  struct Options {
    std::chrono::milliseconds answer{250};                // for a request
    int tries = 4;                                        // of a request
    std::chrono::milliseconds silence{3 * kHeartbeatMs};  // until the watchdog's first step
    std::chrono::milliseconds step{1000};                 // between its steps
    std::chrono::milliseconds poll{kHeartbeatMs};
    std::chrono::milliseconds retry{10000};  // of a configuration that the board has refused
    int periods = 10;                        // of frames: so many without one are a stall;
    std::chrono::milliseconds stall{1000};   // at least this
    FrameAssembler::Options frames;
  };

  /// Steps of the watchdog, in order; the last one repeats.
  enum class Step { kPurge, kRestart, kReopen, kReset };
  static constexpr int kSteps = 4;

  struct Counters {
    std::uint64_t requests = 0, repeated = 0;  // sent, sent again for want of an answer
    std::uint64_t configured = 0;              // whole configurations that were read back
    std::uint64_t unknown_configuration = 0;   // frames dropped: nobody knows what made them
    std::array<std::uint64_t, kSteps> steps{};
  };

  /// A set of frames that came, its tag, and its stamp in the host's time, s. Where images are
  /// the host's own, the stamp is what the host gave.
  struct Received {
    FrameSet set;
    std::uint64_t tag = 0;
    double stamp = 0;
    double arrived = 0;  // host, s: when the last byte came
  };

  Session() : Session(Options{}) {}
  explicit Session(const Options& options) : options_(options) {}

  /// The line is open; everything begins anew.
  void opened(Time now);
  /// The line is lost.
  void closed();

  /// What the board is to do, from now on. Takes effect with a next frame.
  void want(const Wanted& wanted);

  /// Bytes that came. `host` is the host's time of day, s, at which they did.
  void receive(const std::uint8_t* bytes, std::size_t size, Time now, double host);
  /// To be called again and again, at least each 20 ms.
  void tick(Time now, double host);
  /// Bytes to be sent; the caller takes them out, and says when they go.
  std::vector<std::uint8_t>& outgoing() { return outgoing_; }
  /// So many of those have been given to the line. `host`: s, when that began.
  void sent(std::size_t bytes, Time now, double host);

  /// The watchdog asks for this, once.
  std::optional<Step> take_step();
  std::vector<Received> take_received();
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

  State state() const { return state_; }
  /// Why there are no frames, for people; empty where there are.
  std::string complaint() const;
  const std::optional<Identity>& identity() const { return identity_; }
  /// The tag of the configuration that the board has, once it has one of ours and no other waits.
  std::optional<std::uint64_t> configured() const;
  const BoardCounters& board() const { return board_; }
  const Counters& counters() const { return counters_; }
  const Decoder::Counters& line() const { return decoder_.counters(); }
  const FrameAssembler::Counters& frames() const { return assembler_.counters(); }
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
  struct UnderWay {
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
  void await_apply(const GatewareConfiguration& configuration);
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
  void step(const std::string& why);
  void drop_jobs(const Error& error);
  void settle();

  Options options_;
  State state_ = State::kClosed;
  std::string refusal_;  // of the board, or of its settings
  ErrorKind refused_as_ = ErrorKind::kIo;
  std::string trouble_;  // what the watchdog acts upon
  std::optional<Identity> identity_;
  BoardCounters board_;
  Counters counters_;
  TimeSync clock_;

  Decoder decoder_;
  FrameAssembler assembler_;
  FrameSets sets_;
  std::vector<Assembled> assembled_;
  std::vector<FrameSet> complete_;
  std::vector<Received> received_;
  std::vector<std::string> notes_;
  std::vector<std::uint8_t> outgoing_;
  std::uint64_t queued_ = 0, sent_ = 0;  // bytes, since the line was opened
  std::uint64_t pair_end_ = 0;           // of the last pair, among those
  std::deque<PairKey> pairs_;            // that were sent, the last of them
  std::uint32_t sequence_ = kLinkFirstSequence;

  Wanted wanted_;
  bool configuration_stale_ = false;             // the board does not have wanted_.configuration
  bool streams_stale_ = false;                   // nor the rest
  Meshes meshes_;                                // that the board has, if any
  std::map<std::uint32_t, std::uint64_t> tags_;  // from this configuration on
  std::uint32_t configuration_ = 0;              // of the board, as last read
  int attempts_ = 0;                             // to configure
  std::optional<std::uint64_t> board_time_;      // us: when the last answer was sent

  std::deque<Job> jobs_;
  std::optional<UnderWay> under_way_;
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
  std::optional<Step> step_;
};

const char* name(Session::State state);
const char* name(Session::Step step);

}  // namespace fpga_stereo::link
