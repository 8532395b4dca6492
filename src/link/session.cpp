#include "link/session.hpp"

#include <algorithm>
#include <utility>

namespace fpga_stereo::link {
namespace {

constexpr int kAttempts = 3;            // to configure a board that does not hold what is written
constexpr std::size_t kKeptPairs = 64;  // that were sent: more than a board has under way

}  // namespace

void Session::opened(Time now) {
  now_ = last_packet_ = last_byte_ = now;
  next_step_ = now + options_.silence;
  attempts_ = 0;
  refusal_.clear();
  outgoing_.clear();
  queued_ = sent_ = pair_end_ = 0;
  begin_anew();
}

void Session::closed() {
  state_ = LinkState::kClosed;
  identity_.reset();
  drop_jobs({ErrorKind::kUnplugged, "the line to the board is lost"});
  assembler_.reset(assembled_);
  deliver();
  sets_.reset(complete_);
  deliver();
}

void Session::begin_anew() {
  drop_jobs({ErrorKind::kIo, "the board is identified anew"});
  decoder_.reset();
  assembler_.reset(assembled_);
  deliver();
  sets_.reset(complete_);
  deliver();
  pairs_.clear();
  clock_.reset();
  board_time_.reset();
  identity_.reset();
  meshes_ = {};
  tags_.clear();
  next_poll_ = now_ + options_.poll;
  identify();
}

void Session::failed(const Error& error) {
  if (error.kind == ErrorKind::kIncompatible || ++attempts_ >= kAttempts) {
    if (refusal_ != error.message) notes_.push_back(error.message);
    refusal_ = error.message;
    refused_as_ = error.kind;
    next_retry_ = now_ + options_.retry;
    drop_jobs(error);
    tags_.clear();
    state_ = LinkState::kRefused;
    return;
  }
  notes_.push_back(error.message + "; trying again");
  begin_anew();
}

void Session::set_desired_state(const DesiredState& wanted) {
  const auto same = [](const GatewareConfiguration& a, const GatewareConfiguration& b) {
    const auto equal = [](const RegisterWrite& x, const RegisterWrite& y) {
      return x.address == y.address && x.value == y.value;
    };
    return a.mesh == b.mesh && std::equal(a.registers.begin(), a.registers.end(),
                                          b.registers.begin(), b.registers.end(), equal);
  };
  const bool new_configuration =
      wanted.configuration && (!desired_.configuration || wanted.tag != desired_.tag ||
                               !same(*wanted.configuration, *desired_.configuration));
  configuration_stale_ |= new_configuration;
  streams_stale_ |=
      wanted.streams != desired_.streams || wanted.frame_interval != desired_.frame_interval ||
      wanted.raw_interval != desired_.raw_interval || wanted.host_input != desired_.host_input ||
      wanted.mid_exposure != desired_.mid_exposure;
  desired_ = wanted;
  if (state_ == LinkState::kRefused && refused_as_ != ErrorKind::kIncompatible &&
      new_configuration) {
    attempts_ = 0;
    begin_anew();
  }
}

LinkTrouble Session::trouble() const {
  switch (state_) {
    case LinkState::kClosed:
      return LinkTrouble::kNotOpened;
    case LinkState::kRefused:
      return refused_as_ == ErrorKind::kIncompatible ? LinkTrouble::kIncompatible
                                                     : LinkTrouble::kRejected;
    case LinkState::kIdentifying:
      return watchdog_trouble_ == LinkTrouble::kNone ? LinkTrouble::kIdentifying
                                                     : watchdog_trouble_;
    case LinkState::kConfiguring:
      if (watchdog_trouble_ != LinkTrouble::kNone) return watchdog_trouble_;
      return jobs_.empty() ? LinkTrouble::kUnconfigurable : LinkTrouble::kConfiguring;
    default:
      return watchdog_trouble_;
  }
}

std::string Session::trouble_text() const {
  switch (trouble()) {
    case LinkTrouble::kNone:
      return "";
    case LinkTrouble::kIncompatible:
    case LinkTrouble::kRejected:
      return refusal_;
    case LinkTrouble::kIdentifying:
      return "the board is being identified";
    case LinkTrouble::kConfiguring:
      return "the board is being configured";
    case LinkTrouble::kUnconfigurable:
      return "the board waits for a configuration that it can hold";
    case LinkTrouble::kSilent:
    case LinkTrouble::kStalled:
      return watchdog_text_;
    default:
      return "no board";
  }
}

std::optional<std::uint64_t> Session::configured() const {
  const auto after = tags_.upper_bound(configuration_);
  if (configuration_stale_ || after == tags_.begin() || after != tags_.end()) return std::nullopt;
  return std::prev(after)->second;
}

std::optional<WatchdogStep> Session::take_step() { return std::exchange(step_, std::nullopt); }

std::vector<ReceivedFrames> Session::take_received() { return std::exchange(received_, {}); }

std::vector<std::string> Session::take_notes() { return std::exchange(notes_, {}); }

void Session::ask(Request request, Answer answer) {
  if (state_ == LinkState::kClosed)
    return answer(Error{ErrorKind::kUnplugged, "there is no board"});
  jobs_.push_back({std::move(request), {}, std::move(answer), {}});
}

bool Session::send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                        std::uint64_t timestamp) {
  if (pair_end_ > sent_) return false;
  cv::Mat pair;
  cv::hconcat(left, right, pair);
  Header frame;
  frame.stream = Stream::kInput;
  frame.frame_id = frame_id;
  frame.timestamp = timestamp;
  const std::size_t before = outgoing_.size();
  append_frame(frame, pair, 0, 0, kLinkMaxHostPayloadBytes, sequence_, outgoing_);
  pair_end_ = queued_ += outgoing_.size() - before;
  pairs_.emplace_back(frame_id, timestamp);
  if (pairs_.size() > kKeptPairs) pairs_.pop_front();
  return true;
}

void Session::sent(std::size_t bytes, Time now, double host) {
  sent_ += bytes;
  if (!in_flight_ || in_flight_->deadline != Time::max() || sent_ < in_flight_->end) return;
  in_flight_->deadline = now + options_.answer;
  if (in_flight_->tries == 1) in_flight_->sent = host;
}

// What is sent.

void Session::tick(Time now, double host) {
  now_ = now;
  host_ = host;
  if (state_ == LinkState::kClosed) return;
  if (now - last_byte_ > std::chrono::milliseconds(kHostSilenceMs)) {
    last_byte_ = now;
    decoder_.discard_partial_packet();
    receive(nullptr, 0, now, host);
  }
  settle();
  if (now >= next_poll_ && jobs_.empty()) poll();
  start_jobs();
  watch();
}

void Session::start_jobs() {
  if (jobs_.empty()) return;
  if (!in_flight_) {
    if (now_ < jobs_.front().not_before) return;
    in_flight_ = InFlight{++next_id_, 1, host_, 0, {}};
    ++counters_.requests;
    return send_request();
  }
  if (now_ < in_flight_->deadline) return;
  if (in_flight_->tries < options_.tries) {
    // With the same id: whichever answer comes is the answer. It is no measure of the clock.
    ++in_flight_->tries;
    ++counters_.retries;
    in_flight_->sent = host_ - 1;
    return send_request();
  }
  const Job job = std::move(jobs_.front());
  jobs_.pop_front();
  in_flight_.reset();
  if (job.answer) job.answer(Error{ErrorKind::kTimeout, "the board does not answer"});
  step(LinkTrouble::kSilent, "the board does not answer");
}

void Session::send_request() {
  const Request& request = jobs_.front().request;
  Header header;
  header.type = request.type;
  header.index = in_flight_->id;
  header.sequence = sequence_++;
  const std::size_t before = outgoing_.size();
  append_packet(header, request.payload.data(), request.payload.size(), outgoing_);
  in_flight_->end = queued_ += outgoing_.size() - before;
  in_flight_->deadline = Time::max();
}

void Session::drop_jobs(const Error& error) {
  const std::deque<Job> jobs = std::exchange(jobs_, {});
  in_flight_.reset();
  for (const Job& job : jobs) {
    if (job.answer) job.answer(error);
  }
}

// The watchdog.

bool Session::stalled() const {
  if (state_ != LinkState::kStreaming || now_ - last_frame_ < options_.stall) return false;
  const auto allowed = static_cast<std::uint32_t>(options_.periods * desired_.frame_interval);
  return board_.frames_in - input_at_frame_ > allowed;
}

void Session::watch() {
  if (now_ < next_step_) return;
  if (now_ - last_packet_ > options_.silence)
    return step(LinkTrouble::kSilent, "nothing comes from the board");
  if (stalled()) step(LinkTrouble::kStalled, "the board takes images, and no frame comes");
}

void Session::step(LinkTrouble trouble, const std::string& why) {
  // First: what is under way comes out of it, and is no sign that the line works.
  const int rung = ladder_;
  begin_anew();
  watchdog_trouble_ = trouble;
  watchdog_text_ = why;
  step_ = static_cast<WatchdogStep>(rung);
  ladder_ = std::min(rung + 1, kNumWatchdogSteps - 1);
  ++counters_.steps[static_cast<std::size_t>(*step_)];
  notes_.push_back(why + ": " + name(*step_));
  next_step_ = now_ + options_.step;
  last_packet_ = now_;
}

}  // namespace fpga_stereo::link
