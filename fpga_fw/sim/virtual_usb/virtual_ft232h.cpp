#include "sim/virtual_usb/virtual_ft232h.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace fpga_stereo::sim {
namespace {

using Clock = std::chrono::steady_clock;

// Each packet begins with modem status and line status.
constexpr std::uint8_t kOverrun = 0x02;  // bit of the line status
constexpr std::size_t kStatusBytes = 2;

constexpr std::size_t kMaxFifo = 1 << 20;

/// Returns the text without what the emulation of sysfs cannot represent.
std::string plain(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

}  // namespace

VirtualFt232h::VirtualFt232h(FifoBackend& backend, Options options)
    : UsbfsDevice([&] {
        Identity identity;
        identity.vendor = 0x0403;
        identity.product = 0x6014;
        identity.release = 0x0900;
        identity.manufacturer = "fpga_stereo";
        identity.product_name = plain(options.product);
        identity.serial_number = plain(options.serial_number);
        identity.port = options.port;
        identity.high_speed = options.high_speed;
        identity.kernel_driver = options.kernel_driver;
        return identity;
      }()),
      backend_(backend),
      options_(std::move(options)),
      thread_([this] { run(); }) {
  plug();
}

VirtualFt232h::~VirtualFt232h() {
  UsbfsDevice::unplug();
  {
    const std::lock_guard lock(mutex());
    wants_stop_ = true;
  }
  woken_.notify_all();
  thread_.join();
}

void VirtualFt232h::plug() {
  {
    const std::lock_guard lock(mutex());
    seen_ = {};
    clear_fifo();
  }
  UsbfsDevice::plug();
}

void VirtualFt232h::unplug() { UsbfsDevice::unplug(); }

void VirtualFt232h::wake() {
  has_work_ = true;
  woken_.notify_all();
}

template <class T>
void VirtualFt232h::set(T& member, T value) {
  const std::lock_guard lock(mutex());
  member = value;
  wake();
}

void VirtualFt232h::poke() { set(has_work_, true); }

VirtualFt232h::Seen VirtualFt232h::seen() const {
  const std::lock_guard lock(mutex());
  return seen_;
}

void VirtualFt232h::stall_in() {
  const std::lock_guard lock(mutex());
  is_in_halted_ = true;
  if (!urbs(kIn).empty()) finish(urbs(kIn).front(), -EPIPE);
}

void VirtualFt232h::stall_out() {
  const std::lock_guard lock(mutex());
  is_out_halted_ = true;
  if (!urbs(kOut).empty()) finish(urbs(kOut).front(), -EPIPE);
}

void VirtualFt232h::fail_in(int error) { set(next_error_, error); }
void VirtualFt232h::fail_every_in(int error) { set(every_error_, error); }
void VirtualFt232h::report_overrun() { set(has_overrun_, true); }
void VirtualFt232h::limit_packets(std::size_t payload) { set(payload_limit_, payload); }
void VirtualFt232h::send_empty(int num_transfers) { set(num_empty_, num_transfers); }
void VirtualFt232h::hold_requests(bool is_held) { set(are_requests_held_, is_held); }
void VirtualFt232h::keep_latency(int milliseconds) { set(kept_latency_, milliseconds); }

void VirtualFt232h::fail_request(std::uint8_t request) {
  const std::lock_guard lock(mutex());
  failing_requests_.insert(request);
}

void VirtualFt232h::clear_fifo() {
  fifo_.clear();
  fifo_read_ = 0;
}

void VirtualFt232h::on_submitted() {
  seen_.max_pending = std::max(seen_.max_pending, urbs(kIn).size());
  if (!urbs(kIn).empty()) seen_.urb_bytes = urbs(kIn).back()->size;
  if (is_out_halted_ && !urbs(kOut).empty()) finish(urbs(kOut).front(), -EPIPE);
  wake();
}

void VirtualFt232h::on_halt_cleared(std::uint8_t endpoint) {
  ++seen_.halts_cleared;
  (endpoint == kIn ? is_in_halted_ : is_out_halted_) = false;
  wake();
}

void VirtualFt232h::on_reset() {
  ++seen_.usb_resets;
  seen_.bit_mode = 0;
  is_in_halted_ = is_out_halted_ = false;
  clear_fifo();
}

void VirtualFt232h::run() {
  std::unique_lock lock(mutex());
  while (!wants_stop_) {
    has_work_ = false;
    bool worked = fetch(lock);
    worked = send() || worked;
    worked = deliver(lock) || worked;
    if (worked || wants_stop_ || has_work_) continue;
    const auto woken = [&] { return wants_stop_ || has_work_; };
    if (urbs(kIn).empty() || is_in_halted_) {
      woken_.wait(lock, woken);
    } else {
      woken_.wait_until(lock, last_sent_ + send_period(*urbs(kIn).front()), woken);
    }
  }
}

/// Returns the time between two packets that are not full.
std::chrono::milliseconds VirtualFt232h::send_period(const Urb& urb) const {
  const std::chrono::milliseconds latency(seen_.latency_ms);
  const bool has_data = fifo_read_ < fifo_.size() || !urb.bytes.empty();
  return has_data ? latency : std::max(latency, options_.idle_period);
}

/// Reads as many bytes from the backend as the transfers in flight can hold.
bool VirtualFt232h::fetch(std::unique_lock<std::mutex>& lock) {
  if (is_in_halted_ || !is_fifo_running()) return false;
  std::size_t room = 0;
  for (const auto& urb : urbs(kIn)) room += urb->size - urb->bytes.size();
  room = std::min(room, kMaxFifo);
  if (fifo_.size() - fifo_read_ >= room) return false;
  fifo_.erase(fifo_.begin(), fifo_.begin() + static_cast<std::ptrdiff_t>(fifo_read_));
  fifo_read_ = 0;
  std::vector<std::uint8_t> bytes(room - fifo_.size());
  lock.unlock();
  bytes.resize(backend_.transmit(bytes.data(), bytes.size()));
  lock.lock();
  // If the device was unplugged or reset meanwhile, the bytes are lost.
  if (is_fifo_running()) fifo_.insert(fifo_.end(), bytes.begin(), bytes.end());
  return !bytes.empty();
}

/// Fills transfers with packets: full ones, or partial ones when the latency timer expires.
bool VirtualFt232h::send() {
  bool sent = false;
  while (!urbs(kIn).empty() && !is_in_halted_) {
    const UrbPtr urb = urbs(kIn).front();
    const int error = next_error_ != 0 ? std::exchange(next_error_, 0) : every_error_;
    if (error != 0 || num_empty_ > 0) {
      if (error == 0) --num_empty_;
      finish(urb, error);
      sent = true;
      continue;
    }
    const auto now = Clock::now();
    if (!append_packet(*urb, now >= last_sent_ + send_period(*urb))) break;
    last_sent_ = now;
    sent = true;
    if (urb->bytes.size() % packet_bytes() != 0 || urb->bytes.size() + packet_bytes() > urb->size) {
      finish(urb, 0);
    }
  }
  return sent;
}

bool VirtualFt232h::append_packet(Urb& urb, bool is_timer_expired) {
  const std::size_t capacity = packet_bytes() - kStatusBytes;
  const std::size_t limit = payload_limit_ > 0 ? std::min(payload_limit_, capacity) : capacity;
  const std::size_t payload = std::min(limit, fifo_.size() - fifo_read_);
  if (payload < limit && !is_timer_expired) return false;
  const auto overrun = std::exchange(has_overrun_, false) ? kOverrun : std::uint8_t{0};
  urb.bytes.reserve(urb.size);
  urb.bytes.push_back(kModem);
  urb.bytes.push_back(kLine | overrun);
  const auto begin = fifo_.begin() + static_cast<std::ptrdiff_t>(fifo_read_);
  urb.bytes.insert(urb.bytes.end(), begin, begin + static_cast<std::ptrdiff_t>(payload));
  fifo_read_ += payload;
  return true;
}

/// Offers the bytes from the host to the backend.
bool VirtualFt232h::deliver(std::unique_lock<std::mutex>& lock) {
  if (urbs(kOut).empty() || is_out_halted_ || !is_fifo_running()) return false;
  const UrbPtr urb = urbs(kOut).front();
  urb->is_busy = true;
  lock.unlock();
  const std::size_t taken =
      urb->bytes.size() == urb->taken
          ? 0
          : backend_.receive(urb->bytes.data() + urb->taken, urb->bytes.size() - urb->taken);
  lock.lock();
  urb->is_busy = false;
  urb->taken += taken;
  const bool is_finished = urb->taken == urb->bytes.size() || urb->is_discarded;
  if (is_finished) finish(urb, 0);
  return taken > 0 || is_finished;
}

}  // namespace fpga_stereo::sim
