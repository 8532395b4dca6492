#include "sim/usb_gadget/gadget_ft232h.hpp"

#include <endian.h>
#include <linux/usb/functionfs.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>

namespace fpga_stereo::sim {
namespace {

using std::chrono::milliseconds;

// Bytes that the kernel holds for the host at a time. A real chip holds 1 KiB, but dummy_hcd moves
// one such piece per tick of 4 ms.
constexpr std::size_t kSendBytes = 49152;
constexpr milliseconds kRetryPeriod{1};

GadgetFolder::Options folder_options(const Ft232h::Options& options) {
  GadgetFolder::Options folder;
  folder.identity = Ft232h(options).identity();
  folder.high_speed = options.high_speed;
  folder.max_power = Ft232h::kMaxPower;
  return folder;
}

/// Makes SIGUSR2 end a blocking system call, and nothing else.
void catch_signal() {
  struct sigaction action {};
  action.sa_handler = +[](int) {};
  sigemptyset(&action.sa_mask);
  sigaction(SIGUSR2, &action, nullptr);
}

}  // namespace

GadgetFt232h::GadgetFt232h(FifoBackend& backend, const Options& options)
    : backend_(backend),
      folder_("fpga_stereo_" + options.serial_number, folder_options(options)),
      files_("fpga_stereo_" + options.serial_number),
      stop_(eventfd(0, EFD_CLOEXEC)),
      chip_(options) {
  catch_signal();
  control_ = std::thread([this] { serve_requests(); });
  sender_.thread = std::thread([this] { send(); });
  receiver_.thread = std::thread([this] { receive(); });
  try {
    plug();
  } catch (...) {
    stop();
    throw;
  }
}

GadgetFt232h::~GadgetFt232h() {
  unplug();
  stop();
}

void GadgetFt232h::stop() {
  {
    Lock lock(mutex_);
    wants_stop_ = true;
    interrupt(lock);
  }
  eventfd_write(stop_, 1);
  for (std::thread* thread : {&control_, &sender_.thread, &receiver_.thread}) thread->join();
  close(stop_);
}

void GadgetFt232h::plug() {
  {
    const Lock lock(mutex_);
    chip_.power_on();
  }
  folder_.bind();  // without the lock, because the kernel waits for answers to its requests
  const Lock lock(mutex_);
  is_plugged_ = true;
}

void GadgetFt232h::unplug() {
  folder_.unbind();
  Lock lock(mutex_);
  is_plugged_ = is_enabled_ = false;
  interrupt(lock);
}

bool GadgetFt232h::is_plugged() const {
  const Lock lock(mutex_);
  return is_plugged_;
}

void GadgetFt232h::poke() {
  const Lock lock(mutex_);
  ++num_pokes_;
  changed_.notify_all();
}

void GadgetFt232h::stall_in() {
  Lock lock(mutex_);
  if (!is_enabled_) return;
  release(lock, sender_);
  // FunctionFS halts an endpoint when a program moves bytes in the wrong direction. The controller
  // refuses that while it holds a packet for the host.
  std::uint8_t byte = 0;
  for (int i = 0; i < 100; ++i) {
    if (read(files_.in(), &byte, 1) < 0 && errno != EAGAIN) return;
    std::this_thread::sleep_for(kRetryPeriod);
  }
}

void GadgetFt232h::send_empty(int num_transfers) {
  const Lock lock(mutex_);
  num_empty_ = num_transfers;
  ++num_pokes_;
  changed_.notify_all();
}

void GadgetFt232h::limit_packets(std::size_t payload) {
  const Lock lock(mutex_);
  chip_.limit_packets(payload);
}

void GadgetFt232h::serve_requests() {
  std::array<usb_functionfs_event, 4> events{};
  std::array<pollfd, 2> files{{{files_.control(), POLLIN, 0}, {stop_, POLLIN, 0}}};
  while (true) {
    if (poll(files.data(), files.size(), -1) < 0) continue;
    if (files[1].revents != 0) return;
    const auto size = read(files_.control(), events.data(), sizeof(events));
    if (size < 0) {  // the host has given a request up
      std::this_thread::sleep_for(kRetryPeriod);
      continue;
    }
    const auto count = static_cast<std::size_t>(size) / sizeof(usb_functionfs_event);
    for (std::size_t i = 0; i < count; ++i) {
      if (events[i].type == FUNCTIONFS_SETUP) answer(events[i].u.setup);
      if (events[i].type == FUNCTIONFS_ENABLE) on_enabled();
      if (events[i].type == FUNCTIONFS_DISABLE || events[i].type == FUNCTIONFS_UNBIND) {
        Lock lock(mutex_);
        is_enabled_ = false;
        interrupt(lock);
      }
    }
  }
}

void GadgetFt232h::answer(const usb_ctrlrequest& request) {
  const UsbSetup setup{request.bRequestType, request.bRequest, le16toh(request.wValue),
                       le16toh(request.wIndex), le16toh(request.wLength)};
  std::vector<std::uint8_t> bytes;
  bool is_accepted = setup.is_in() || setup.length == 0;
  if (is_accepted) {
    Lock lock(mutex_);
    // What the movers hold is part of the FIFO.
    if (Ft232h::empties_fifo(setup)) interrupt(lock);
    is_accepted = chip_.handle(setup, bytes);
    ++num_pokes_;
    changed_.notify_all();
  }
  // Moving bytes in the wrong direction stalls the request. If the host has given the request up,
  // the result is an error, and the host knows.
  if (setup.is_in() == is_accepted) {
    const std::size_t size = std::min<std::size_t>(bytes.size(), setup.length);
    [[maybe_unused]] const auto written = write(files_.control(), bytes.data(), size);
  } else {
    [[maybe_unused]] const auto done = read(files_.control(), bytes.data(), 0);
  }
}

/// The host has configured the device, perhaps after resetting it: the kernel may leave out that
/// the device was disabled between.
void GadgetFt232h::on_enabled() {
  Lock lock(mutex_);
  interrupt(lock);
  chip_.usb_reset();
  chip_.set_packet_bytes(files_.packet_bytes());
  is_enabled_ = true;
  changed_.notify_all();
}

template <class Call>
std::int64_t GadgetFt232h::block(Lock& lock, Mover& mover, const Call& call) {
  mover.is_blocked = true;
  lock.unlock();
  const std::int64_t result = call();
  const int error = errno;
  lock.lock();
  mover.is_blocked = false;
  changed_.notify_all();
  return result < 0 ? -error : result;
}

void GadgetFt232h::release(Lock& lock, Mover& mover) {
  // A signal that comes just before the system call is lost, so send more of them.
  while (mover.is_blocked) {
    pthread_kill(mover.thread.native_handle(), SIGUSR2);
    changed_.wait_for(lock, kRetryPeriod);
  }
}

void GadgetFt232h::interrupt(Lock& lock) {
  ++epoch_;
  ++num_interrupting_;
  release(lock, sender_);
  release(lock, receiver_);
  --num_interrupting_;
  changed_.notify_all();
}

void GadgetFt232h::wait(Lock& lock, Ft232h::Clock::time_point deadline) {
  const auto epoch = epoch_, num_pokes = num_pokes_;
  changed_.wait_until(lock, deadline, [&] { return epoch_ != epoch || num_pokes_ != num_pokes; });
}

void GadgetFt232h::wait_for_interrupt(Lock& lock, std::uint64_t epoch) {
  changed_.wait(lock, [&] { return epoch_ != epoch; });
}

/// Waits until the chip may move bytes. Returns false if the thread must end.
bool GadgetFt232h::wait_until_enabled(Lock& lock) {
  changed_.wait(lock, [&] { return wants_stop_ || (is_enabled_ && num_interrupting_ == 0); });
  return !wants_stop_;
}

/// Reads as many bytes from the backend as the next transfer can hold.
void GadgetFt232h::fetch(Lock& lock) {
  if (!chip_.is_running()) return;
  const auto epoch = epoch_;
  std::vector<std::uint8_t> bytes(chip_.room(kSendBytes));
  lock.unlock();
  bytes.resize(backend_.transmit(bytes.data(), bytes.size()));
  lock.lock();
  if (epoch == epoch_) chip_.push(bytes);
}

void GadgetFt232h::send() {
  pthread_setname_np(pthread_self(), "gadget send");
  std::vector<std::uint8_t> bytes;
  Lock lock(mutex_);
  while (wait_until_enabled(lock)) {
    const auto epoch = epoch_;
    fetch(lock);
    if (epoch != epoch_) continue;
    bytes.clear();
    const bool is_empty = num_empty_ > 0;
    if (is_empty) {
      --num_empty_;
    } else {
      const std::size_t packet = chip_.packet_bytes();
      while (bytes.size() + packet <= kSendBytes && chip_.append_packet(bytes)) {
        if (bytes.size() % packet != 0) break;
      }
      if (bytes.empty()) {
        wait(lock, chip_.timer_end());
        continue;
      }
    }
    const auto sent =
        block(lock, sender_, [&] { return write(files_.in(), bytes.data(), bytes.size()); });
    if (sent < 0 && sent != -EINTR) wait_for_interrupt(lock, epoch);
  }
}

void GadgetFt232h::receive() {
  pthread_setname_np(pthread_self(), "gadget receive");
  std::vector<std::uint8_t> bytes;
  Lock lock(mutex_);
  while (wait_until_enabled(lock)) {
    const auto epoch = epoch_;
    // One packet at a time, because the kernel holds back full packets until a read is complete.
    bytes.resize(chip_.packet_bytes());
    const auto size =
        block(lock, receiver_, [&] { return read(files_.out(), bytes.data(), bytes.size()); });
    if (size < 0 && size != -EINTR) wait_for_interrupt(lock, epoch);
    std::int64_t taken = 0;
    while (taken < size && epoch == epoch_) {
      const auto num_pokes = num_pokes_;
      std::size_t count = 0;
      if (chip_.is_running()) {
        lock.unlock();
        count = backend_.receive(bytes.data() + taken, static_cast<std::size_t>(size - taken));
        lock.lock();
      }
      taken += static_cast<std::int64_t>(count);
      changed_.wait(lock, [&] { return count > 0 || num_pokes != num_pokes_ || epoch != epoch_; });
    }
  }
}

}  // namespace fpga_stereo::sim
