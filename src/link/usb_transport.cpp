#include "link/usb_transport.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "link/ftdi.hpp"

namespace fpga_stereo::link {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// One transfer at a time is sent: behind one that was given up, none may have gone. So it is large.
constexpr std::size_t kOutBytes = 262144;
constexpr milliseconds kPatience{1000};  // until cancelled transfers have ended
// A cable that is being pulled gives errors until the hub has noticed, in 200 ms at most.
constexpr int kMostHalts = 10;
constexpr milliseconds kHaltPause{25};

}  // namespace

UsbTransport::UsbTransport(UsbDevice device, const UsbOptions& options)
    : device_(std::move(device)), options_(options) {
  const std::size_t packets = (options.transfer_bytes + device_.packet - 1) / device_.packet;
  const std::size_t size = std::max<std::size_t>(packets, 1) * device_.packet;
  const auto at_least = static_cast<std::size_t>(std::max(options.transfers, 1));
  buffers_.resize(std::max(at_least, options.buffer_bytes / size));
  for (auto& buffer : buffers_) {
    buffer.owner = this;
    buffer.transfer.reset(libusb_alloc_transfer(0));
    buffer.bytes.resize(size);
    libusb_fill_bulk_transfer(buffer.transfer.get(), device_.handle.get(), device_.in,
                              buffer.bytes.data(), static_cast<int>(size), &received, &buffer, 0);
    free_.push_back(&buffer);
  }
  out_.owner = this;
  out_.transfer.reset(libusb_alloc_transfer(0));
  out_.bytes.resize(kOutBytes);
}

UsbTransport::~UsbTransport() {
  pause();
  stop_ = true;
  libusb_interrupt_event_handler(device_.context.get());
  if (thread_.joinable()) thread_.join();
  // Transfers that have not ended by now do with this, and their memory is freed after it.
  device_.handle.reset();
}

Status UsbTransport::start() {
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "board usb");
  resume();
  const std::lock_guard lock(mutex_);
  if (failed_) return *failed_;
  return {};
}

void UsbTransport::fail(int code, const std::string& what) {
  if (!failed_) failed_ = usb_error(code, device_.name + what);
  changed_.notify_all();
}

void UsbTransport::submit() {
  while (!free_.empty() && flying_ < options_.transfers && !paused_ && !halted_ && !failed_) {
    Buffer& buffer = *free_.front();
    if (const int code = libusb_submit_transfer(buffer.transfer.get()); code != 0) {
      fail(code, " takes no transfer");
      return;
    }
    free_.pop_front();
    buffer.flying = true;
    ++flying_;
  }
}

void UsbTransport::cancel() {
  for (auto& buffer : buffers_) {
    if (buffer.flying) libusb_cancel_transfer(buffer.transfer.get());
  }
}

void UsbTransport::received(libusb_transfer* transfer) {
  auto& buffer = *static_cast<Buffer*>(transfer->user_data);
  buffer.owner->take(buffer);
}

void UsbTransport::take(Buffer& buffer) {
  const std::lock_guard lock(mutex_);
  buffer.flying = false;
  --flying_;
  const auto& transfer = *buffer.transfer;
  // Whatever the end was like, these bytes have come.
  const auto stripped = strip_status(
      buffer.bytes.data(), static_cast<std::size_t>(transfer.actual_length), device_.packet);
  counters_.stalls += stripped.overruns;
  buffer.begin = 0;
  buffer.end = stripped.size;
  (stripped.size > 0 ? arrived_ : free_).push_back(&buffer);
  switch (transfer.status) {
    case LIBUSB_TRANSFER_COMPLETED:
      halts_in_a_row_ = 0;
      break;
    case LIBUSB_TRANSFER_CANCELLED:
    case LIBUSB_TRANSFER_TIMED_OUT:
      break;
    case LIBUSB_TRANSFER_NO_DEVICE:
      fail(LIBUSB_ERROR_NO_DEVICE, "");
      break;
    case LIBUSB_TRANSFER_STALL:
    case LIBUSB_TRANSFER_ERROR:
    case LIBUSB_TRANSFER_OVERFLOW:
      halted_ = true;  // run() clears it
      break;
  }
  submit();
  changed_.notify_all();
}

void UsbTransport::run() {
  while (!stop_) {
    timeval wait{1, 0};
    const int code = libusb_handle_events_timeout_completed(device_.context.get(), &wait, nullptr);
    if (code != 0 && code != LIBUSB_ERROR_INTERRUPTED) std::this_thread::sleep_for(kHaltPause);
    overcome_halt();
  }
}

/// The transfers behind a halt never end by themselves; and the halt can only be cleared when there
/// are none.
void UsbTransport::overcome_halt() {
  std::unique_lock lock(mutex_);
  if (!halted_ || paused_ || failed_) return;
  if (flying_ > 0) {
    cancel();
    return;
  }
  const bool once_more = ++halts_in_a_row_ <= kMostHalts;
  const bool pause = halts_in_a_row_ > 1;
  lock.unlock();
  if (pause) std::this_thread::sleep_for(kHaltPause);
  const bool cleared = once_more && clear_halt(device_.in);
  lock.lock();
  halted_ = false;
  if (!once_more) fail(LIBUSB_ERROR_PIPE, " halts again and again");
  if (cleared) ++counters_.stalls;
  submit();
}

bool UsbTransport::clear_halt(std::uint8_t endpoint) {
  const int code = libusb_clear_halt(device_.handle.get(), endpoint);
  if (code == 0) return true;
  const std::lock_guard lock(mutex_);
  fail(code, ": a halt cannot be cleared");
  return false;
}

Result<std::size_t> UsbTransport::read(std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return !arrived_.empty() || failed_; });
  std::size_t done = 0;
  while (done < size && !arrived_.empty()) {
    Buffer& buffer = *arrived_.front();
    const std::size_t part = std::min(size - done, buffer.end - buffer.begin);
    std::memcpy(bytes + done, buffer.bytes.data() + buffer.begin, part);
    buffer.begin += part;
    done += part;
    if (buffer.begin < buffer.end) break;
    arrived_.pop_front();
    free_.push_back(&buffer);
  }
  submit();
  counters_.bytes_in += done;
  if (done == 0 && failed_) return *failed_;
  return done;
}

void UsbTransport::sent(libusb_transfer* transfer) {
  auto& owner = *static_cast<Buffer*>(transfer->user_data)->owner;
  const std::lock_guard lock(owner.mutex_);
  owner.out_.flying = false;
  owner.changed_.notify_all();
}

/// Sends the first bytes of out_: how many went. None if the line halted or failed.
std::optional<std::size_t> UsbTransport::send(std::size_t size, Clock::time_point until) {
  std::unique_lock lock(mutex_);
  auto* transfer = out_.transfer.get();
  libusb_fill_bulk_transfer(transfer, device_.handle.get(), device_.out, out_.bytes.data(),
                            static_cast<int>(size), &sent, &out_, 0);
  if (const int code = libusb_submit_transfer(transfer); code != 0) {
    fail(code, " takes no transfer");
    return std::nullopt;
  }
  out_.flying = true;
  const auto landed = [&] { return !out_.flying; };
  if (!changed_.wait_until(lock, until, landed)) {
    libusb_cancel_transfer(transfer);
    if (!changed_.wait_for(lock, kPatience, landed)) {
      fail(LIBUSB_ERROR_TIMEOUT, " does not let go of a transfer");
      return std::nullopt;
    }
  }
  const auto went = static_cast<std::size_t>(transfer->actual_length);
  switch (transfer->status) {
    case LIBUSB_TRANSFER_NO_DEVICE:
      fail(LIBUSB_ERROR_NO_DEVICE, "");
      return std::nullopt;
    case LIBUSB_TRANSFER_STALL:
    case LIBUSB_TRANSFER_ERROR:
    case LIBUSB_TRANSFER_OVERFLOW:
      lock.unlock();
      if (!clear_halt(device_.out)) return std::nullopt;
      lock.lock();
      ++counters_.stalls;
      break;
    case LIBUSB_TRANSFER_COMPLETED:
    case LIBUSB_TRANSFER_CANCELLED:
    case LIBUSB_TRANSFER_TIMED_OUT:
      break;
  }
  counters_.bytes_out += went;
  return went;
}

Result<std::size_t> UsbTransport::write(const std::uint8_t* bytes, std::size_t size,
                                        Timeout timeout) {
  const auto until = Clock::now() + timeout;
  std::size_t done = 0;
  while (done < size) {
    {
      const std::lock_guard lock(mutex_);
      if (failed_) return *failed_;
    }
    const std::size_t part = std::min(size - done, kOutBytes);
    std::memcpy(out_.bytes.data(), bytes + done, part);
    const auto went = send(part, until);
    done += went.value_or(0);
    if (went.value_or(0) < part && Clock::now() >= until) break;
  }
  return done;
}

bool UsbTransport::pause() {
  std::unique_lock lock(mutex_);
  paused_ = true;
  cancel();
  if (out_.flying) libusb_cancel_transfer(out_.transfer.get());
  if (!thread_.joinable()) return idle();
  return changed_.wait_for(lock, kPatience, [&] { return idle(); });
}

void UsbTransport::resume() {
  const std::lock_guard lock(mutex_);
  free_.insert(free_.end(), arrived_.begin(), arrived_.end());
  arrived_.clear();
  paused_ = false;
  halted_ = false;
  halts_in_a_row_ = 0;
  submit();
}

Status UsbTransport::recover(Recovery step) {
  {
    const std::lock_guard lock(mutex_);
    if (failed_ && failed_->kind == ErrorKind::kUnplugged) return *failed_;
    failed_.reset();
  }
  const bool paused = pause();
  if (step == Recovery::kReset) {
    const int code = libusb_reset_device(device_.handle.get());
    const std::lock_guard lock(mutex_);
    // It may have come back as another device.
    failed_ = Error{ErrorKind::kUnplugged, device_.name + " was reset: open it anew"};
    if (code != 0 && code != LIBUSB_ERROR_NOT_FOUND) {
      return usb_error(code, device_.name + " cannot be reset");
    }
    return {};
  }
  if (!paused) {
    return usb_error(LIBUSB_ERROR_TIMEOUT, device_.name + " does not let go of its transfers");
  }
  for (const auto endpoint : {device_.in, device_.out}) {
    if (!clear_halt(endpoint)) break;
  }
  Status set_up =
      step == Recovery::kPurge ? purge_ftdi(device_) : set_up_ftdi(device_, options_.latency_ms);
  resume();
  const std::lock_guard lock(mutex_);
  if (failed_) return *failed_;
  return set_up;
}

Transport::Counters UsbTransport::counters() const {
  const std::lock_guard lock(mutex_);
  return counters_;
}

namespace {

Result<std::unique_ptr<Transport>> open_and_start(const UsbSelection& selection,
                                                  const UsbOptions& options) {
  auto device = open_usb_device(selection);
  if (!device) return device.error();
  if (const Status set_up = set_up_ftdi(*device, options.latency_ms); !set_up) {
    return set_up.error();
  }
  auto transport = std::make_unique<UsbTransport>(*device, options);
  device = Error{};  // the transport's is the last: it closes the device
  if (const Status started = transport->start(); !started) return started.error();
  return std::unique_ptr<Transport>(std::move(transport));
}

}  // namespace

Result<std::unique_ptr<Transport>> open_usb(const UsbSelection& selection,
                                            const UsbOptions& options) {
  auto opened = open_and_start(selection, options);
  // Unplugged in the meantime: as good as never there.
  if (!opened && opened.error().kind == ErrorKind::kUnplugged) {
    return Error{ErrorKind::kNotFound, opened.error().message};
  }
  return opened;
}

}  // namespace fpga_stereo::link
