#include "link/device_threads.hpp"

#include <pthread.h>

#include <future>
#include <utility>

#include "link/hotplug_watch.hpp"

namespace fpga_stereo::link {
namespace {

using std::chrono::milliseconds;

// Bounds how long the session is locked, whatever the bytes are.
constexpr std::size_t kReadBytes = 1 << 16;
constexpr milliseconds kReadTimeout{5};  // bounds the delay of what others want to send
// Short, because nothing is read meanwhile: USB buffers 100 ms.
constexpr milliseconds kWriteTimeout{10};
constexpr milliseconds kStreamsOffTimeout{500};

double system_time() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(now).count();
}

LinkTrouble trouble_of(const Error& error) {
  switch (error.kind) {
    case ErrorKind::kNotFound:
      return LinkTrouble::kNoDevice;
    case ErrorKind::kBusy:
      return LinkTrouble::kBusy;
    case ErrorKind::kPermission:
      return LinkTrouble::kPermission;
    case ErrorKind::kUnplugged:
      return LinkTrouble::kUnplugged;
    default:
      return LinkTrouble::kIo;
  }
}

Transport::Counters sum(const Transport::Counters& a, const Transport::Counters& b) {
  return {a.bytes_in + b.bytes_in, a.bytes_out + b.bytes_out, a.stalls + b.stalls};
}

}  // namespace

DeviceThreads::DeviceThreads(Device::Options options, Device::Callbacks callbacks)
    : options_(std::move(options)),
      callbacks_(std::move(callbacks)),
      queue_(options_.max_waiting_frame_sets),
      in_(kReadBytes),
      session_(options_.session) {
  if (!options_.host_clock) options_.host_clock = system_time;
}

void DeviceThreads::start() {
  link_thread_ = std::thread([this] { run_link(); });
  pthread_setname_np(link_thread_.native_handle(), "board link");
  delivery_thread_ = std::thread([this] { run_delivery(); });
  pthread_setname_np(delivery_thread_.native_handle(), "board frames");
}

void DeviceThreads::stop() {
  const auto deadline = Clock::now() + kStreamsOffTimeout;
  {
    const MutexLock lock(mutex_);
    session_.set_desired_state({});
    while (session_.state() == LinkState::kStreaming) {
      if (!changed_.wait_until(mutex_, deadline)) break;
    }
    is_stopping_ = true;
    changed_.notify_all();
  }
  if (options_.hotplug) options_.hotplug->interrupt();
  link_thread_.join();
  queue_.finish();
  delivery_thread_.join();
}

void DeviceThreads::set_desired_state(const DesiredState& desired) {
  const MutexLock lock(mutex_);
  session_.set_desired_state(desired);
}

bool DeviceThreads::send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                              std::uint64_t timestamp) {
  const MutexLock lock(mutex_);
  if (session_.state() != LinkState::kStreaming) return false;
  return session_.send_pair(left, right, frame_id, timestamp);
}

Result<std::vector<RegisterWrite>> DeviceThreads::ask(const Request& request) {
  using Answer = Result<std::vector<RegisterWrite>>;
  auto promise = std::make_shared<std::promise<Answer>>();
  std::future<Answer> answer = promise->get_future();
  {
    const MutexLock lock(mutex_);
    if (session_.state() == LinkState::kClosed) {
      return Error{ErrorKind::kUnplugged, closed_text_};
    }
    session_.ask(request, [promise](Answer a) { promise->set_value(std::move(a)); });
  }
  return answer.get();
}

void DeviceThreads::reset() {
  const MutexLock lock(mutex_);
  is_reset_requested_ = true;
}

Device::Snapshot DeviceThreads::snapshot() const {
  Device::Snapshot s;
  s.undelivered = queue_.dropped();
  const MutexLock lock(mutex_);
  s.state = session_.state();
  const bool is_closed = s.state == LinkState::kClosed;
  s.trouble = is_closed ? closed_trouble_ : session_.trouble();
  s.trouble_text = is_closed ? closed_text_ : session_.trouble_text();
  s.description = description_;
  s.identity = session_.identity();
  s.active_tag = session_.active_tag();
  s.board = session_.board();
  s.session = session_.counters();
  s.decoder = session_.line();
  s.frames = session_.frames();
  s.transport = transport_counters_;
  s.times_opened = times_opened_;
  s.clock_drift = session_.clock().drift();
  s.clock_uncertainty = session_.clock().uncertainty();
  return s;
}

// The link thread.

void DeviceThreads::run_link() {
  while (true) {
    {
      const MutexLock lock(mutex_);
      if (is_stopping_) break;
    }
    if (!transport_ && !open()) continue;
    const Status moved = exchange();
    const auto step = hand_over();
    if (step) perform(*step);
    if (!moved && transport_) {
      queue_.push(NoteEvent{moved.error().message});
      close(trouble_of(moved.error()), moved.error().message);
    }
  }
  if (transport_) close(LinkTrouble::kNotOpened, "the device is being closed");
}

bool DeviceThreads::open() {
  auto opened = options_.open();
  if (!opened) {
    const std::string& why = opened.error().message;
    if (why != open_error_) queue_.push(NoteEvent{why});
    open_error_ = why;
    {
      const MutexLock lock(mutex_);
      closed_text_ = why;
      closed_trouble_ = trouble_of(opened.error());
    }
    wait_to_retry();
    return false;
  }
  open_error_.clear();
  transport_ = std::move(*opened);
  out_.clear();
  written_ = 0;
  was_identified_ = false;
  std::string description = transport_->description();
  queue_.push(NoteEvent{"opened " + description});
  const MutexLock lock(mutex_);
  description_ = std::move(description);
  ++times_opened_;
  session_.opened(Clock::now());
  return true;
}

void DeviceThreads::wait_to_retry() {
  if (options_.hotplug) {
    options_.hotplug->wait(options_.retry);
    return;
  }
  const auto deadline = Clock::now() + options_.retry;
  const MutexLock lock(mutex_);
  while (!is_stopping_) {
    if (!changed_.wait_until(mutex_, deadline)) break;
  }
}

void DeviceThreads::close(LinkTrouble trouble, const std::string& why) {
  closed_counters_ = sum(closed_counters_, transport_->counters());
  {
    const MutexLock lock(mutex_);
    transport_counters_ = closed_counters_;
    closed_text_ = why;
    closed_trouble_ = trouble;
    session_.closed();
    description_.clear();
    changed_.notify_all();
  }
  transport_.reset();
  hand_over();
  queue_.push(ClosedEvent{});
}

Status DeviceThreads::write_some() {
  if (written_ == out_.size()) {
    const MutexLock lock(mutex_);
    out_.clear();
    written_ = 0;
    std::swap(out_, session_.outgoing());
  }
  if (written_ == out_.size()) return {};
  const Time began = Clock::now();
  const auto sent = transport_->write(&out_[written_], out_.size() - written_, kWriteTimeout);
  if (!sent) return sent.error();
  written_ += *sent;
  const MutexLock lock(mutex_);
  session_.sent(*sent, Clock::now(), began);
  return {};
}

std::pair<Time, double> DeviceThreads::read_clocks() const {
  // Read as one: a thread that loses the processor in between would see a step of the time of day.
  constexpr int kTries = 5;
  std::pair<Time, double> best;
  auto shortest = Clock::duration::max();
  for (int i = 0; i < kTries && shortest > std::chrono::microseconds(20); ++i) {
    const Time before = Clock::now();
    const double wall = options_.host_clock();
    const auto taken = Clock::now() - before;
    if (taken >= shortest) continue;
    shortest = taken;
    best = {before + taken / 2, wall};
  }
  return best;
}

Status DeviceThreads::exchange() {
  if (Status written = write_some(); !written) return written;
  const bool has_more = written_ < out_.size();
  const auto count =
      transport_->read(in_.data(), in_.size(), has_more ? Transport::Timeout{1} : kReadTimeout);
  if (!count) return count.error();
  const auto [now, wall] = read_clocks();
  const Transport::Counters counters = sum(closed_counters_, transport_->counters());
  const MutexLock lock(mutex_);
  if (*count > 0) session_.receive(in_.data(), *count, now, wall);
  session_.tick(now, wall);
  transport_counters_ = counters;
  changed_.notify_all();
  return {};
}

std::optional<WatchdogStep> DeviceThreads::hand_over() {
  std::vector<ReceivedFrames> received;
  std::vector<std::string> notes;
  std::optional<WatchdogStep> step;
  std::optional<Identity> identity;
  {
    const MutexLock lock(mutex_);
    received = session_.take_received();
    notes = session_.take_notes();
    step = session_.take_step();
    if (std::exchange(is_reset_requested_, false)) step = WatchdogStep::kReset;
    const LinkState state = session_.state();
    const bool is_identified =
        session_.identity() && state != LinkState::kRefused && state != LinkState::kIdentifying;
    if (is_identified && !was_identified_) identity = session_.identity();
    was_identified_ = is_identified;
  }
  for (std::string& note : notes) queue_.push(NoteEvent{std::move(note)});
  if (identity) queue_.push(IdentifiedEvent{*identity});
  for (ReceivedFrames& frames : received) queue_.push(std::move(frames));
  return step;
}

void DeviceThreads::perform(WatchdogStep step) {
  if (!transport_) return;
  Status done;
  switch (step) {
    case WatchdogStep::kPurge:
      done = transport_->recover(Recovery::kPurge);
      break;
    case WatchdogStep::kRestart:
      done = transport_->recover(Recovery::kRestart);
      break;
    case WatchdogStep::kReset:
      done = transport_->recover(Recovery::kReset);
      break;
    case WatchdogStep::kReopen:
      break;
  }
  if (!done) queue_.push(NoteEvent{done.error().message});
  const bool must_close = step == WatchdogStep::kReopen || step == WatchdogStep::kReset;
  if (!must_close && done) return;
  close(LinkTrouble::kReopening, std::string("the link is being opened again: ") + name(step));
}

// The delivery thread.

void DeviceThreads::run_delivery() {
  while (auto event = queue_.pop()) deliver(std::move(*event));
}

void DeviceThreads::deliver(DeliveryEvent event) {
  if (auto* frames = std::get_if<ReceivedFrames>(&event)) {
    if (callbacks_.received) callbacks_.received(std::move(*frames));
  } else if (const auto* identified = std::get_if<IdentifiedEvent>(&event)) {
    if (callbacks_.identified) callbacks_.identified(identified->identity);
  } else if (const auto* note = std::get_if<NoteEvent>(&event)) {
    if (callbacks_.note) callbacks_.note(note->text);
  } else if (callbacks_.closed) {
    callbacks_.closed();
  }
}

}  // namespace fpga_stereo::link
