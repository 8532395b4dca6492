#include "link/session.hpp"

#include <fmt/core.h>

#include <iterator>
#include <stdexcept>
#include <utility>

namespace fpga_stereo::link {
namespace {

constexpr int kMaxFailures = 3;  // before a board that does not hold its configuration is refused

}  // namespace

Session::Session(const SessionOptions& options)
    : options_(options),
      outbox_(std::make_unique<Outbox>()),
      requests_(std::make_unique<RequestQueue>(options, *outbox_)),
      configurator_(std::make_unique<Configurator>(*requests_, options.tries)),
      receiver_(options.keep_incomplete),
      watchdog_(options) {}

// States.

void Session::enter(LinkEvent event) {
  const auto next = next_state(state_, event);
  if (!next) {
    throw std::logic_error(
        fmt::format("link state {} has no transition for {}", name(state_), name(event)));
  }
  state_ = *next;
}

void Session::opened(Time now) {
  if (state_ != LinkState::kClosed) closed();
  now_ = last_byte_ = now;
  watchdog_.start(now);
  failures_ = 0;
  refusal_ = {};
  outbox_->clear();
  pair_end_ = 0;
  enter(LinkEvent::kOpened);
  restart();
}

void Session::closed() {
  enter(LinkEvent::kClosed);
  configurator_->forget_identity();
  requests_->clear({ErrorKind::kUnplugged, "the link to the board is lost"});
  flush();
}

/// Forgets the board and identifies it again. The caller enters the state.
void Session::restart() {
  requests_->clear({ErrorKind::kIo, "the board is being identified again"});
  decoder_.reset();
  flush();
  receiver_.forget_board();
  board_time_.reset();
  polled_.reset();
  next_poll_ = now_ + options_.poll;
  configurator_->restart();
}

void Session::fail(const Error& error) {
  if (error.kind == ErrorKind::kIncompatible || ++failures_ >= kMaxFailures) {
    if (refusal_.message != error.message) notes_.push_back(error.message);
    refusal_ = error;
    next_retry_ = now_ + options_.retry;
    requests_->clear(error);
    configurator_->tags().clear();
    return enter(LinkEvent::kRefused);
  }
  notes_.push_back(error.message + "; trying again");
  enter(LinkEvent::kRestarted);
  restart();
}

void Session::step(const Trouble& trouble) {
  // Read first: restart() delivers the frames in flight, which are no sign that the link works.
  const WatchdogStep step = watchdog_.next_step();
  enter(LinkEvent::kRestarted);
  restart();
  watchdog_.take(step, trouble, now_);
  step_ = step;
  notes_.push_back(fmt::format("{}: {}", trouble.text, name(step)));
}

void Session::set_desired_state(const DesiredState& desired) {
  const bool is_new = configurator_->set_desired_state(desired);
  if (is_new && state_ == LinkState::kRefused && refusal_.kind != ErrorKind::kIncompatible) {
    failures_ = 0;
    enter(LinkEvent::kRestarted);
    restart();
  }
}

LinkTrouble Session::trouble() const {
  const LinkTrouble watchdog = watchdog_.trouble().kind;
  switch (state_) {
    case LinkState::kClosed:
      return LinkTrouble::kNotOpened;
    case LinkState::kRefused:
      return refusal_.kind == ErrorKind::kIncompatible ? LinkTrouble::kIncompatible
                                                       : LinkTrouble::kRejected;
    case LinkState::kIdentifying:
      return watchdog != LinkTrouble::kNone ? watchdog : LinkTrouble::kIdentifying;
    case LinkState::kConfiguring:
      if (watchdog != LinkTrouble::kNone) return watchdog;
      return requests_->empty() ? LinkTrouble::kUnconfigurable : LinkTrouble::kConfiguring;
    case LinkState::kReady:
    case LinkState::kStreaming:
      return watchdog;
  }
  return watchdog;
}

std::string Session::trouble_text() const {
  switch (trouble()) {
    case LinkTrouble::kNone:
      return "";
    case LinkTrouble::kIncompatible:
    case LinkTrouble::kRejected:
      return refusal_.message;
    case LinkTrouble::kIdentifying:
      return "the board is being identified";
    case LinkTrouble::kConfiguring:
      return "the board is being configured";
    case LinkTrouble::kUnconfigurable:
      return "no configuration for the board's build has been given";
    case LinkTrouble::kSilent:
    case LinkTrouble::kStalled:
    case LinkTrouble::kNoImages:
      return watchdog_.trouble().text;
    default:
      return "no board";
  }
}

SessionCounters Session::counters() const {
  SessionCounters counters;
  counters.requests = requests_->sent_count();
  counters.retries = requests_->retry_count();
  counters.configurations = configurator_->applied_count();
  counters.unknown_configurations = receiver_.unknown_configurations();
  counters.steps = watchdog_.steps();
  return counters;
}

// What the session hands over.

std::optional<WatchdogStep> Session::take_step() { return std::exchange(step_, std::nullopt); }

std::vector<ReceivedFrames> Session::take_received() {
  return std::exchange(receiver_.received(), {});
}

std::vector<std::string> Session::take_notes() {
  std::vector<std::string> notes = std::exchange(notes_, {});
  std::vector<std::string> more = std::exchange(receiver_.notes(), {});
  notes.insert(notes.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
  return notes;
}

void Session::ask(Request request, OnResult on_result) {
  if (state_ == LinkState::kClosed) {
    return on_result(Error{ErrorKind::kUnplugged, "there is no board"});
  }
  requests_->push_user_request(std::move(request), std::move(on_result));
}

bool Session::send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                        std::uint64_t timestamp) {
  if (pair_end_ > outbox_->sent()) return false;
  cv::Mat pair;
  cv::hconcat(left, right, pair);
  Header frame;
  frame.stream = Stream::kInput;
  frame.frame_id = frame_id;
  frame.timestamp = timestamp;
  outbox_->add_frame(frame, pair);
  pair_end_ = outbox_->queued();
  receiver_.add_host_pair(frame_id, timestamp);
  return true;
}

void Session::sent(std::size_t bytes, Time now, Time began) {
  const bool had_pair = pair_end_ > outbox_->sent();
  outbox_->mark_sent(bytes);
  if (had_pair && pair_end_ <= outbox_->sent()) watchdog_.on_pair_sent(now);
  requests_->on_sent(now, began);
}

// Time.

int Session::frame_interval() const {
  const DesiredState& desired = configurator_->desired();
  constexpr StreamSet kRaw{Stream::kRawLeft, Stream::kRawRight};
  const bool is_raw_only = (desired.streams - kRaw).empty();
  return desired.frame_interval * (is_raw_only ? desired.raw_interval : 1);
}

void Session::tick(Time now, double wall) {
  read_clocks(now, wall);
  if (state_ == LinkState::kClosed) return;
  if (now - last_byte_ > std::chrono::milliseconds(kHostSilenceMs)) {
    last_byte_ = now;
    decoder_.discard_partial_packet();
    receive(nullptr, 0, now, wall);
  }
  advance();
  if (now >= next_poll_ && requests_->empty()) poll();
  if (!requests_->tick(now)) {
    step({LinkTrouble::kSilent, "the board does not answer"});
  }
  const bool is_streaming = state_ == LinkState::kStreaming;
  if (const auto trouble = watchdog_.check(now, is_streaming, frame_interval())) step(*trouble);
}

void Session::advance() {
  const bool is_known = state_ != LinkState::kIdentifying && state_ != LinkState::kRefused;
  if (!is_known || !requests_->empty()) return;
  switch (configurator_->advance()) {
    case Configurator::Progress::kStreams:
      return watchdog_.on_streams_changed(now_, board_.frames_in,
                                          configurator_->desired().host_input);
    case Configurator::Progress::kWorking:
    case Configurator::Progress::kBlocked:
      return;
    case Configurator::Progress::kDone:
      failures_ = 0;
      refusal_ = {};
      return enter(configurator_->desired().streams.empty() ? LinkEvent::kStreamsOff
                                                            : LinkEvent::kStreamsOn);
  }
}

}  // namespace fpga_stereo::link
