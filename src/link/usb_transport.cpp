#include "link/usb_transport.hpp"

#include <pthread.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "link/ftdi.hpp"

namespace fpga_stereo::link {
namespace {

using std::chrono::milliseconds;

// One transfer is in flight at a time: bytes of a later one must not follow one that was cancelled.
// So it is large.
constexpr std::size_t kOutBytes = 262144;
constexpr milliseconds kCancelTimeout{1000};
// A cable that is being pulled gives errors until the hub notices, within 200 ms.
constexpr int kMaxHalts = 10;
constexpr milliseconds kHaltPause{25};

}  // namespace

UsbTransport::UsbTransport(UsbDevice device, const UsbOptions& options)
    : device_(std::move(device)), options_(options) {
  const std::size_t packets = (options.transfer_bytes + device_.packet - 1) / device_.packet;
  const std::size_t size = std::max<std::size_t>(packets, 1) * device_.packet;
  const auto min_buffers = static_cast<std::size_t>(std::max(options.transfers, 1));
  buffers_.resize(std::max(min_buffers, options.buffer_bytes / size));
  for (auto& buffer : buffers_) {
    buffer.owner = this;
    buffer.transfer.reset(libusb_alloc_transfer(0));
    buffer.bytes.resize(size);
    libusb_fill_bulk_transfer(buffer.transfer.get(), device_.handle.get(), device_.in,
                              buffer.bytes.data(), static_cast<int>(size), &on_received, &buffer,
                              0);
    free_.push_back(&buffer);
  }
  out_.owner = this;
  out_.transfer.reset(libusb_alloc_transfer(0));
  out_.bytes.resize(kOutBytes);
}

UsbTransport::~UsbTransport() {
  pause();
  is_stopping_ = true;
  libusb_interrupt_event_handler(device_.context.get());
  if (thread_.joinable()) thread_.join();
  // Closing the device ends the transfers that are still in flight, before their memory is freed.
  device_.handle.reset();
}

Status UsbTransport::start() {
  thread_ = std::thread([this] { run(); });
  pthread_setname_np(thread_.native_handle(), "board usb");
  resume();
  const MutexLock lock(mutex_);
  if (failure_) return *failure_;
  return {};
}

void UsbTransport::fail(int code, const std::string& what) {
  if (!failure_) failure_ = usb_error(code, device_.name + what);
  changed_.notify_all();
}

void UsbTransport::submit() {
  while (!free_.empty() && in_flight_ < options_.transfers && !is_paused_ && !is_halted_ &&
         !failure_) {
    Buffer& buffer = *free_.front();
    if (const int code = libusb_submit_transfer(buffer.transfer.get()); code != 0) {
      fail(code, " accepts no transfer");
      return;
    }
    free_.pop_front();
    buffer.is_in_flight = true;
    ++in_flight_;
  }
}

void UsbTransport::cancel() {
  for (auto& buffer : buffers_) {
    if (buffer.is_in_flight) libusb_cancel_transfer(buffer.transfer.get());
  }
}

void UsbTransport::on_received(libusb_transfer* transfer) {
  auto& buffer = *static_cast<Buffer*>(transfer->user_data);
  buffer.owner->take(buffer);
}

void UsbTransport::take(Buffer& buffer) {
  const MutexLock lock(mutex_);
  buffer.is_in_flight = false;
  --in_flight_;
  const auto& transfer = *buffer.transfer;
  // Bytes that came before an error are valid.
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
      is_halted_ = true;  // cleared by run()
      break;
  }
  submit();
  changed_.notify_all();
}

void UsbTransport::run() {
  while (!is_stopping_) {
    timeval timeout{1, 0};
    const int code =
        libusb_handle_events_timeout_completed(device_.context.get(), &timeout, nullptr);
    if (code != 0 && code != LIBUSB_ERROR_INTERRUPTED) std::this_thread::sleep_for(kHaltPause);
    overcome_halt();
  }
}

/// Clears a halt of the receiving endpoint. Transfers submitted after it never end by themselves,
/// and the halt can only be cleared while none is in flight: so this cancels them first.
void UsbTransport::overcome_halt() {
  MutexLock lock(mutex_);
  if (!is_halted_ || is_paused_ || failure_) return;
  if (in_flight_ > 0) {
    cancel();
    return;
  }
  const bool may_retry = ++halts_in_a_row_ <= kMaxHalts;
  const bool must_pause = halts_in_a_row_ > 1;
  lock.unlock();
  if (must_pause) std::this_thread::sleep_for(kHaltPause);
  const bool is_cleared = may_retry && clear_halt(device_.in);
  lock.lock();
  is_halted_ = false;
  if (!may_retry) fail(LIBUSB_ERROR_PIPE, " halts again and again");
  if (is_cleared) ++counters_.stalls;
  submit();
}

bool UsbTransport::clear_halt(std::uint8_t endpoint) {
  // A cable that is being pulled refuses this, too, until the hub notices.
  const auto deadline = Clock::now() + kMaxHalts * kHaltPause;
  int code = libusb_clear_halt(device_.handle.get(), endpoint);
  while (code != 0 && code != LIBUSB_ERROR_NO_DEVICE && Clock::now() < deadline) {
    std::this_thread::sleep_for(kHaltPause);
    code = libusb_clear_halt(device_.handle.get(), endpoint);
  }
  if (code == 0) return true;
  const MutexLock lock(mutex_);
  fail(code, ": a halt cannot be cleared");
  return false;
}

Result<std::size_t> UsbTransport::read(std::uint8_t* bytes, std::size_t size, Timeout timeout) {
  const auto deadline = Clock::now() + timeout;
  const MutexLock lock(mutex_);
  while (arrived_.empty() && !failure_) {
    if (!changed_.wait_until(mutex_, deadline)) break;
  }
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
  if (done == 0 && failure_) return *failure_;
  return done;
}

void UsbTransport::on_sent(libusb_transfer* transfer) {
  auto& owner = *static_cast<Buffer*>(transfer->user_data)->owner;
  const MutexLock lock(owner.mutex_);
  owner.out_.is_in_flight = false;
  owner.changed_.notify_all();
}

std::optional<std::size_t> UsbTransport::send(std::size_t size, Clock::time_point deadline) {
  MutexLock lock(mutex_);
  auto* transfer = out_.transfer.get();
  libusb_fill_bulk_transfer(transfer, device_.handle.get(), device_.out, out_.bytes.data(),
                            static_cast<int>(size), &on_sent, &out_, 0);
  if (const int code = libusb_submit_transfer(transfer); code != 0) {
    fail(code, " accepts no transfer");
    return std::nullopt;
  }
  out_.is_in_flight = true;
  while (out_.is_in_flight) {
    if (!changed_.wait_until(mutex_, deadline)) break;
  }
  if (out_.is_in_flight) {
    libusb_cancel_transfer(transfer);
    const auto cancel_deadline = Clock::now() + kCancelTimeout;
    while (out_.is_in_flight) {
      if (changed_.wait_until(mutex_, cancel_deadline)) continue;
      if (!out_.is_in_flight) break;
      fail(LIBUSB_ERROR_TIMEOUT, " does not release a transfer");
      return std::nullopt;
    }
  }
  const auto count = static_cast<std::size_t>(transfer->actual_length);
  switch (transfer->status) {
    case LIBUSB_TRANSFER_NO_DEVICE:
      fail(LIBUSB_ERROR_NO_DEVICE, "");
      return std::nullopt;
    case LIBUSB_TRANSFER_STALL:
    case LIBUSB_TRANSFER_ERROR:
    case LIBUSB_TRANSFER_OVERFLOW: {
      lock.unlock();
      const bool is_cleared = clear_halt(device_.out);
      lock.lock();
      if (!is_cleared) return std::nullopt;
      ++counters_.stalls;
      break;
    }
    case LIBUSB_TRANSFER_COMPLETED:
    case LIBUSB_TRANSFER_CANCELLED:
    case LIBUSB_TRANSFER_TIMED_OUT:
      break;
  }
  counters_.bytes_out += count;
  return count;
}

Result<std::size_t> UsbTransport::write(const std::uint8_t* bytes, std::size_t size,
                                        Timeout timeout) {
  const auto deadline = Clock::now() + timeout;
  std::size_t done = 0;
  while (done < size) {
    const std::size_t part = std::min(size - done, kOutBytes);
    {
      const MutexLock lock(mutex_);
      if (failure_) return *failure_;
      std::memcpy(out_.bytes.data(), bytes + done, part);
    }
    const auto count = send(part, deadline);
    done += count.value_or(0);
    if (count.value_or(0) < part && Clock::now() >= deadline) break;
  }
  return done;
}

bool UsbTransport::pause() {
  const MutexLock lock(mutex_);
  is_paused_ = true;
  cancel();
  if (out_.is_in_flight) libusb_cancel_transfer(out_.transfer.get());
  if (!thread_.joinable()) return is_idle();
  const auto deadline = Clock::now() + kCancelTimeout;
  while (!is_idle()) {
    if (!changed_.wait_until(mutex_, deadline)) break;
  }
  return is_idle();
}

void UsbTransport::resume() {
  const MutexLock lock(mutex_);
  free_.insert(free_.end(), arrived_.begin(), arrived_.end());
  arrived_.clear();
  is_paused_ = false;
  is_halted_ = false;
  halts_in_a_row_ = 0;
  submit();
}

Status UsbTransport::recover(Recovery step) {
  {
    const MutexLock lock(mutex_);
    if (failure_ && failure_->kind == ErrorKind::kUnplugged) return *failure_;
    failure_.reset();
  }
  const bool is_paused = pause();
  if (step == Recovery::kReset) {
    const int code = libusb_reset_device(device_.handle.get());
    const MutexLock lock(mutex_);
    // The device may come back with another address.
    failure_ = Error{ErrorKind::kUnplugged, device_.name + " was reset: open it again"};
    if (code != 0 && code != LIBUSB_ERROR_NOT_FOUND) {
      return usb_error(code, device_.name + " cannot be reset");
    }
    return {};
  }
  if (!is_paused) {
    return usb_error(LIBUSB_ERROR_TIMEOUT, device_.name + " does not release its transfers");
  }
  for (const auto endpoint : {device_.in, device_.out}) {
    if (!clear_halt(endpoint)) break;
  }
  Status set_up =
      step == Recovery::kPurge ? purge_ftdi(device_) : set_up_ftdi(device_, options_.latency_ms);
  resume();
  const MutexLock lock(mutex_);
  if (failure_) return *failure_;
  return set_up;
}

Transport::Counters UsbTransport::counters() const {
  const MutexLock lock(mutex_);
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
  device = Error{};  // leaves the transport's copy as the last: it closes the device
  if (const Status started = transport->start(); !started) return started.error();
  return std::unique_ptr<Transport>(std::move(transport));
}

}  // namespace

Result<std::unique_ptr<Transport>> open_usb(const UsbSelection& selection,
                                            const UsbOptions& options) {
  auto opened = open_and_start(selection, options);
  // A board that is unplugged while it is being opened was not found.
  if (!opened && opened.error().kind == ErrorKind::kUnplugged) {
    return Error{ErrorKind::kNotFound, opened.error().message};
  }
  return opened;
}

}  // namespace fpga_stereo::link
