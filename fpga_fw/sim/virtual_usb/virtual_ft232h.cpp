#include "sim/virtual_usb/virtual_ft232h.hpp"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace fpga_stereo::sim {
namespace {

constexpr std::size_t kMaxFifo = 1 << 20;

/// Returns the text without what the emulation of sysfs cannot represent.
std::string plain(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text;
}

}  // namespace

VirtualFt232h::VirtualFt232h(FifoBackend& backend, const Options& options)
    : UsbfsDevice([&] {
        Identity identity;
        static_cast<UsbIdentity&>(identity) = Ft232h(options).identity();
        identity.product_name = plain(identity.product_name);
        identity.serial_number = plain(identity.serial_number);
        identity.port = options.port;
        identity.high_speed = options.high_speed;
        identity.kernel_driver = options.kernel_driver;
        return identity;
      }()),
      backend_(backend),
      chip_(options),
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
    chip_.power_on();
  }
  UsbfsDevice::plug();
}

void VirtualFt232h::unplug() { UsbfsDevice::unplug(); }

void VirtualFt232h::wake() {
  has_work_ = true;
  woken_.notify_all();
}

template <class Change>
void VirtualFt232h::apply(const Change& change) {
  const std::lock_guard lock(mutex());
  change();
  wake();
}

void VirtualFt232h::poke() {
  apply([] {});
}

VirtualFt232h::Seen VirtualFt232h::seen() const {
  const std::lock_guard lock(mutex());
  Seen seen = seen_;
  static_cast<Ft232h::Seen&>(seen) = chip_.seen();
  return seen;
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

void VirtualFt232h::fail_in(int error) {
  apply([&] { next_error_ = error; });
}
void VirtualFt232h::fail_every_in(int error) {
  apply([&] { every_error_ = error; });
}
void VirtualFt232h::report_overrun() {
  apply([&] { chip_.report_overrun(); });
}
void VirtualFt232h::limit_packets(std::size_t payload) {
  apply([&] { chip_.limit_packets(payload); });
}
void VirtualFt232h::send_empty(int num_transfers) {
  apply([&] { num_empty_ = num_transfers; });
}
void VirtualFt232h::hold_requests(bool is_held) {
  apply([&] { are_requests_held_ = is_held; });
}
void VirtualFt232h::keep_latency(int milliseconds) {
  apply([&] { chip_.keep_latency(milliseconds); });
}
void VirtualFt232h::fail_request(std::uint8_t request) {
  apply([&] { chip_.fail_request(request); });
}

int VirtualFt232h::control(const UsbSetup& setup, std::vector<std::uint8_t>& bytes) {
  if (are_requests_held_) return kHold;
  if (setup.type == 0x80 && setup.request == 6 && setup.value >> 8 == 3) {
    return string_descriptor(setup, bytes);
  }
  if (!chip_.handle(setup, bytes)) return -EPIPE;
  wake();
  return 0;
}

int VirtualFt232h::string_descriptor(const UsbSetup& setup,
                                     std::vector<std::uint8_t>& bytes) const {
  const UsbIdentity identity = chip_.identity();
  const std::string texts[] = {identity.manufacturer, identity.product_name,
                               identity.serial_number};
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
  chip_.usb_reset();
  is_in_halted_ = is_out_halted_ = false;
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
      woken_.wait_until(lock, chip_.timer_end(), woken);
    }
  }
}

/// Reads as many bytes from the backend as the transfers in flight can hold.
bool VirtualFt232h::fetch(std::unique_lock<std::mutex>& lock) {
  if (is_in_halted_ || !chip_.is_running()) return false;
  std::size_t size = 0;
  for (const auto& urb : urbs(kIn)) size += urb->size - urb->bytes.size();
  const std::size_t room = chip_.room(std::min(size, kMaxFifo));
  if (room == 0) return false;
  std::vector<std::uint8_t> bytes(room);
  lock.unlock();
  bytes.resize(backend_.transmit(bytes.data(), bytes.size()));
  lock.lock();
  chip_.push(bytes);
  return !bytes.empty();
}

/// Fills transfers with packets.
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
    if (urb->bytes.empty()) urb->bytes.reserve(urb->size);
    if (!chip_.append_packet(urb->bytes)) break;
    sent = true;
    const std::size_t packet = chip_.packet_bytes();
    if (urb->bytes.size() % packet != 0 || urb->bytes.size() + packet > urb->size) finish(urb, 0);
  }
  return sent;
}

/// Offers the bytes from the host to the backend.
bool VirtualFt232h::deliver(std::unique_lock<std::mutex>& lock) {
  if (urbs(kOut).empty() || is_out_halted_ || !chip_.is_running()) return false;
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
