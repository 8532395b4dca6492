#include "fpga_stereo/link/device.hpp"

#include <pthread.h>

#include <algorithm>
#include <future>
#include <utility>

#include "link/hotplug_watch.hpp"

namespace fpga_stereo::link {
namespace {

using Clock = Session::Clock;
using std::chrono::milliseconds;

constexpr std::size_t kReadBytes = 1 << 20;
constexpr milliseconds kReadTime{5};  // until what others ask for is sent
// A line that takes nothing must not keep what comes waiting: USB has buffers for 100 ms.
constexpr milliseconds kWriteTime{10};
constexpr milliseconds kGoodbye{500};

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

}  // namespace

Device::Device(Options options, Callbacks callbacks)
    : options_(std::move(options)),
      callbacks_(std::move(callbacks)),
      in_(kReadBytes),
      session_(options_.session),
      closed_because_("no board was looked for yet") {
  if (!options_.host_clock) options_.host_clock = system_time;
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "board");
}

Device::~Device() {
  set_desired_state({});
  const auto deadline = Clock::now() + kGoodbye;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    const auto quiet = [this] { return session_.state() != LinkState::kStreaming; };
    wake_.wait_until(lock, deadline, quiet);
    stopping_ = true;
  }
  wake_.notify_all();
  if (options_.hotplug) options_.hotplug->interrupt();
  thread_.join();
}

void Device::set_desired_state(const DesiredState& wanted) {
  const std::lock_guard<std::mutex> lock(mutex_);
  session_.set_desired_state(wanted);
}

bool Device::send_pair(const cv::Mat1b& left, const cv::Mat1b& right, std::uint64_t frame_id,
                       std::uint64_t timestamp) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (session_.state() != LinkState::kStreaming) return false;
  return session_.send_pair(left, right, frame_id, timestamp);
}

Result<std::vector<RegisterWrite>> Device::ask(const Request& request) {
  using Answer = Result<std::vector<RegisterWrite>>;
  auto promise = std::make_shared<std::promise<Answer>>();
  std::future<Answer> answer = promise->get_future();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (session_.state() == LinkState::kClosed) {
      return Error{ErrorKind::kUnplugged, closed_because_};
    }
    session_.ask(request, [promise](Answer a) { promise->set_value(std::move(a)); });
  }
  return answer.get();
}

Result<std::vector<RegisterWrite>> Device::read_registers(
    const std::vector<std::uint32_t>& addresses) {
  std::vector<RegisterWrite> values;
  for (std::size_t first = 0; first < addresses.size(); first += kMaxReads) {
    const auto begin = addresses.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::min(kMaxReads, addresses.size() - first);
    const auto part = ask(read_request({begin, begin + static_cast<std::ptrdiff_t>(count)}));
    if (!part) return part.error();
    values.insert(values.end(), part->begin(), part->end());
  }
  return values;
}

Status Device::write_registers(const std::vector<RegisterWrite>& writes) {
  for (std::size_t first = 0; first < writes.size(); first += kMaxWrites) {
    const auto begin = writes.begin() + static_cast<std::ptrdiff_t>(first);
    const std::size_t count = std::min(kMaxWrites, writes.size() - first);
    const auto done = ask(write_request({begin, begin + static_cast<std::ptrdiff_t>(count)}));
    if (!done) return done.error();
  }
  return {};
}

void Device::reset() {
  const std::lock_guard<std::mutex> lock(mutex_);
  reset_asked_ = true;
}

Device::Snapshot Device::snapshot() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Snapshot s;
  s.state = session_.state();
  const bool is_closed = s.state == LinkState::kClosed;
  s.trouble = is_closed ? closed_trouble_ : session_.trouble();
  s.trouble_text = is_closed ? closed_because_ : session_.trouble_text();
  s.description = description_;
  s.identity = session_.identity();
  s.active_tag = session_.configured();
  s.board = session_.board();
  s.session = session_.counters();
  s.decoder = session_.line();
  s.frames = session_.frames();
  s.transport = transport_counters_;
  s.times_opened = opened_;
  s.clock_drift = session_.clock().drift();
  s.clock_uncertainty = session_.clock().uncertainty();
  return s;
}

void Device::run() {
  while (true) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (stopping_) break;
    }
    if (!transport_ && !open()) continue;
    const Status moved = exchange();
    hand_on();
    if (!moved) {
      callbacks_.note(moved.error().message);
      close(trouble_of(moved.error()), moved.error().message);
    }
  }
  if (transport_) close(LinkTrouble::kNotOpened, "the device is being closed");
}

bool Device::open() {
  auto opened = options_.open();
  if (!opened) {
    const std::string& why = opened.error().message;
    if (why != open_error_) callbacks_.note(why);
    open_error_ = why;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      closed_because_ = why;
      closed_trouble_ = trouble_of(opened.error());
    }
    wait_to_retry();
    return false;
  }
  open_error_.clear();
  transport_ = std::move(*opened);
  out_.clear();
  sent_ = 0;
  told_identity_ = false;
  std::string description = transport_->description();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    description_ = description;
    ++opened_;
    session_.opened(Clock::now());
  }
  callbacks_.note("opened " + description);
  return true;
}

void Device::wait_to_retry() {
  if (options_.hotplug) {
    options_.hotplug->wait(options_.retry);
    return;
  }
  std::unique_lock<std::mutex> lock(mutex_);
  wake_.wait_for(lock, options_.retry, [this] { return stopping_; });
}

void Device::close(LinkTrouble trouble, const std::string& why) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_because_ = why;
    closed_trouble_ = trouble;
    session_.closed();
    description_.clear();
  }
  transport_.reset();
  hand_on();
  if (callbacks_.closed) callbacks_.closed();
}

Status Device::exchange() {
  if (sent_ == out_.size()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    out_.clear();
    sent_ = 0;
    std::swap(out_, session_.outgoing());
  }
  const bool sending = sent_ < out_.size();
  if (sending) {
    const double began = options_.host_clock();
    const auto sent = transport_->write(&out_[sent_], out_.size() - sent_, kWriteTime);
    if (!sent) return sent.error();
    sent_ += *sent;
    const std::lock_guard<std::mutex> lock(mutex_);
    session_.sent(*sent, Clock::now(), began);
  }
  const bool more = sent_ < out_.size();
  const auto came =
      transport_->read(in_.data(), in_.size(), more ? Transport::Timeout{1} : kReadTime);
  if (!came) return came.error();
  const auto now = Clock::now();
  const double host = options_.host_clock();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (*came > 0) session_.receive(in_.data(), *came, now, host);
  session_.tick(now, host);
  transport_counters_ = transport_->counters();
  wake_.notify_all();
  return {};
}

void Device::hand_on() {
  std::vector<ReceivedFrames> received;
  std::vector<std::string> notes;
  std::optional<WatchdogStep> step;
  std::optional<Identity> identity;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    received = session_.take_received();
    notes = session_.take_notes();
    step = session_.take_step();
    if (std::exchange(reset_asked_, false)) step = WatchdogStep::kReset;
    const bool known = session_.identity() && session_.state() != LinkState::kRefused &&
                       session_.state() != LinkState::kIdentifying;
    if (known && !told_identity_) identity = session_.identity();
    told_identity_ = known;
  }
  for (const std::string& note : notes) callbacks_.note(note);
  if (identity) callbacks_.identified(*identity);
  if (!received.empty()) callbacks_.received(std::move(received));
  if (step && transport_) serve(*step);
}

void Device::serve(WatchdogStep step) {
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
  if (!done) callbacks_.note(done.error().message);
  const bool closes = step == WatchdogStep::kReopen || step == WatchdogStep::kReset;
  if (!closes && done) return;
  close(LinkTrouble::kReopening, std::string("the line is being opened anew: ") + name(step));
}

}  // namespace fpga_stereo::link
