#include "sim/virtual_usb/virtual_ft232h.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace fpga_stereo::sim {
namespace {

using Clock = std::chrono::steady_clock;

// Vendor requests.
constexpr std::uint8_t kReset = 0x00, kFlowControl = 0x02, kBaudRate = 0x03, kModemStatus = 0x05;
constexpr std::uint8_t kSetLatency = 0x09, kGetLatency = 0x0A, kBitMode = 0x0B, kReadEeprom = 0x90;

// Behind every packet's start: modem status, line status.
constexpr std::uint8_t kModem = 0x32, kLine = 0x60, kOverrun = 0x02;
constexpr std::size_t kStatusBytes = 2;

constexpr std::size_t kMostStaged = 1 << 20;

}  // namespace

VirtualFt232h::VirtualFt232h(FifoBackend& backend, Options options)
    : UsbfsDevice([&] {
        Identity identity;
        identity.vendor = 0x0403;
        identity.product = 0x6014;
        identity.release = 0x0900;
        identity.manufacturer = "FTDI";
        identity.product_name = options.product;
        identity.serial_number = options.serial_number;
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
    stop_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void VirtualFt232h::plug() {
  {
    const std::lock_guard lock(mutex());
    seen_ = {};
    forget();
  }
  UsbfsDevice::plug();
}

void VirtualFt232h::unplug() { UsbfsDevice::unplug(); }

void VirtualFt232h::poke() {
  {
    const std::lock_guard lock(mutex());
    poked_ = true;
  }
  wake_.notify_all();
}

VirtualFt232h::Seen VirtualFt232h::seen() const {
  const std::lock_guard lock(mutex());
  return seen_;
}

void VirtualFt232h::stall_in() {
  const std::lock_guard lock(mutex());
  in_halted_ = true;
  if (!urbs(kIn).empty()) finish(urbs(kIn).front(), -EPIPE);
}

void VirtualFt232h::stall_out() {
  const std::lock_guard lock(mutex());
  out_halted_ = true;
  if (!urbs(kOut).empty()) finish(urbs(kOut).front(), -EPIPE);
}

void VirtualFt232h::fail_in(int error) {
  {
    const std::lock_guard lock(mutex());
    next_error_ = error;
  }
  poke();
}

void VirtualFt232h::fail_every_in(int error) {
  {
    const std::lock_guard lock(mutex());
    every_error_ = error;
  }
  poke();
}

void VirtualFt232h::report_overrun() {
  const std::lock_guard lock(mutex());
  overrun_ = true;
}

void VirtualFt232h::limit_packets(std::size_t payload) {
  const std::lock_guard lock(mutex());
  payload_limit_ = payload;
}

void VirtualFt232h::send_empty(int transfers) {
  {
    const std::lock_guard lock(mutex());
    empty_ = transfers;
  }
  poke();
}

void VirtualFt232h::fail_request(std::uint8_t request) {
  const std::lock_guard lock(mutex());
  failing_[request] = true;
}

void VirtualFt232h::hold_requests(bool hold) {
  const std::lock_guard lock(mutex());
  hold_ = hold;
}

void VirtualFt232h::keep_latency(int milliseconds) {
  const std::lock_guard lock(mutex());
  kept_latency_ = milliseconds;
}

void VirtualFt232h::forget() {
  staged_.clear();
  staged_at_ = 0;
}

int VirtualFt232h::control(const Setup& setup, std::vector<std::uint8_t>& bytes) {
  if (hold_) return kHold;
  if (failing_.count(setup.request) > 0) return -EPIPE;
  if (setup.type == 0x40) return vendor_out(setup);
  if (setup.type == 0xC0) return vendor_in(setup, bytes);
  if (setup.type == 0x80 && setup.request == 6 && setup.value >> 8 == 3) {
    return string_descriptor(setup, bytes);
  }
  return -EPIPE;
}

int VirtualFt232h::vendor_out(const Setup& setup) {
  switch (setup.request) {
    case kReset:
      if (setup.value == 0) {
        ++seen_.resets;
      } else {
        ++seen_.purges;
      }
      forget();
      return 0;
    case kFlowControl:
      seen_.flow_control = setup.index & 0xFF00;
      return 0;
    case kBaudRate:
      return 0;
    case kSetLatency:
      if (setup.value < 1 || setup.value > 255) return -EPIPE;
      seen_.latency_ms = setup.value;
      return 0;
    case kBitMode:
      seen_.bit_mode = setup.value >> 8;
      poked_ = true;
      wake_.notify_all();
      return 0;
    default:
      return -EPIPE;
  }
}

int VirtualFt232h::vendor_in(const Setup& setup, std::vector<std::uint8_t>& bytes) const {
  switch (setup.request) {
    case kModemStatus:
      bytes = {kModem, kLine};
      return 0;
    case kGetLatency:
      bytes = {static_cast<std::uint8_t>(kept_latency_ < 0 ? seen_.latency_ms : kept_latency_)};
      return 0;
    case kReadEeprom: {
      // Words behind the first: vendor, product, release; then of no interest here.
      const std::uint16_t words[] = {options_.eeprom_mode, 0x0403, 0x6014, 0x0900};
      const std::uint16_t word = options_.eeprom_mode == 0xFFFF ? std::uint16_t{0xFFFF}
                                 : setup.index < 4              ? words[setup.index]
                                                                : std::uint16_t{0};
      bytes = {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8)};
      return 0;
    }
    default:
      return -EPIPE;
  }
}

int VirtualFt232h::string_descriptor(const Setup& setup, std::vector<std::uint8_t>& bytes) const {
  const std::string texts[] = {identity_.manufacturer, options_.product, options_.serial_number};
  const std::size_t index = setup.value & 0xFF;
  if (index > 3) return -EPIPE;
  bytes = {0, 3};
  if (index == 0) {
    bytes.insert(bytes.end(), {0x09, 0x04});  // US English
  } else {
    for (const char letter : texts[index - 1]) {
      bytes.insert(bytes.end(), {static_cast<std::uint8_t>(letter), 0});
    }
  }
  bytes[0] = static_cast<std::uint8_t>(bytes.size());
  return 0;
}

void VirtualFt232h::submitted() {
  seen_.most_pending = std::max(seen_.most_pending, urbs(kIn).size());
  if (!urbs(kIn).empty()) seen_.urb_bytes = urbs(kIn).back()->size;
  if (out_halted_ && !urbs(kOut).empty()) finish(urbs(kOut).front(), -EPIPE);
  poked_ = true;
  wake_.notify_all();
}

void VirtualFt232h::halt_cleared(std::uint8_t endpoint) {
  ++seen_.halts_cleared;
  (endpoint == kIn ? in_halted_ : out_halted_) = false;
  poked_ = true;
  wake_.notify_all();
}

void VirtualFt232h::reset() {
  ++seen_.usb_resets;
  seen_.bit_mode = 0;
  in_halted_ = out_halted_ = false;
  forget();
}

void VirtualFt232h::run() {
  std::unique_lock lock(mutex());
  while (!stop_) {
    poked_ = false;
    bool worked = fetch(lock);
    worked = send() || worked;
    worked = take(lock) || worked;
    if (worked || stop_ || poked_) continue;
    const auto woken = [&] { return stop_ || poked_; };
    if (urbs(kIn).empty() || in_halted_) {
      wake_.wait(lock, woken);
    } else {
      const std::chrono::milliseconds latency(seen_.latency_ms);
      const bool data = staged_at_ < staged_.size() || !urbs(kIn).front()->bytes.empty();
      const auto period = data ? latency : std::max(latency, options_.idle_period);
      wake_.wait_until(lock, last_sent_ + period, woken);
    }
  }
}

/// Takes from the backend what the transfers under way can hold.
bool VirtualFt232h::fetch(std::unique_lock<std::mutex>& lock) {
  if (in_halted_ || !fifo_runs()) return false;
  std::size_t room = 0;
  for (const auto& urb : urbs(kIn)) room += urb->size - urb->bytes.size();
  room = std::min(room, kMostStaged);
  if (staged_.size() - staged_at_ >= room) return false;
  staged_.erase(staged_.begin(), staged_.begin() + static_cast<std::ptrdiff_t>(staged_at_));
  staged_at_ = 0;
  std::vector<std::uint8_t> bytes(room - staged_.size());
  lock.unlock();
  bytes.resize(backend_.transmit(bytes.data(), bytes.size()));
  lock.lock();
  // Unplugged or purged meanwhile: as good as lost in the cable.
  if (fifo_runs()) staged_.insert(staged_.end(), bytes.begin(), bytes.end());
  return !bytes.empty();
}

/// Fills transfers with packets: full ones, or whatever there is when the latency timer expires.
bool VirtualFt232h::send() {
  bool sent = false;
  while (!urbs(kIn).empty() && !in_halted_) {
    const UrbPtr urb = urbs(kIn).front();
    const int error = next_error_ != 0 ? std::exchange(next_error_, 0) : every_error_;
    if (error != 0 || empty_ > 0) {
      if (error == 0) --empty_;
      finish(urb, error);
      sent = true;
      continue;
    }
    const auto now = Clock::now();
    const std::chrono::milliseconds latency(seen_.latency_ms);
    const bool data = staged_at_ < staged_.size() || !urb->bytes.empty();
    const bool timer =
        now >= last_sent_ + (data ? latency : std::max(latency, options_.idle_period));
    if (!append_packet(*urb, timer)) break;
    last_sent_ = now;
    sent = true;
    if (urb->bytes.size() % packet_bytes() != 0 || urb->bytes.size() + packet_bytes() > urb->size) {
      finish(urb, 0);
    }
  }
  return sent;
}

bool VirtualFt232h::append_packet(Urb& urb, bool timer) {
  const std::size_t most = packet_bytes() - kStatusBytes;
  const std::size_t limit = payload_limit_ > 0 ? std::min(payload_limit_, most) : most;
  const std::size_t payload = std::min(limit, staged_.size() - staged_at_);
  if (payload < limit && !timer) return false;
  const auto overrun = std::exchange(overrun_, false) ? kOverrun : std::uint8_t{0};
  urb.bytes.reserve(urb.size);
  urb.bytes.push_back(kModem);
  urb.bytes.push_back(kLine | overrun);
  const auto begin = staged_.begin() + static_cast<std::ptrdiff_t>(staged_at_);
  urb.bytes.insert(urb.bytes.end(), begin, begin + static_cast<std::ptrdiff_t>(payload));
  staged_at_ += payload;
  return true;
}

/// Offers the backend what the host has sent.
bool VirtualFt232h::take(std::unique_lock<std::mutex>& lock) {
  if (urbs(kOut).empty() || out_halted_ || !fifo_runs()) return false;
  const UrbPtr urb = urbs(kOut).front();
  urb->busy = true;
  lock.unlock();
  const std::size_t taken =
      urb->bytes.size() == urb->taken
          ? 0
          : backend_.receive(urb->bytes.data() + urb->taken, urb->bytes.size() - urb->taken);
  lock.lock();
  urb->busy = false;
  urb->taken += taken;
  const bool over = urb->taken == urb->bytes.size() || urb->discarded;
  if (over) finish(urb, 0);
  return taken > 0 || over;
}

}  // namespace fpga_stereo::sim
