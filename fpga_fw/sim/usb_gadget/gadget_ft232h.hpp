// A virtual FT232H as a USB gadget: the kernel of this machine carries it over a USB device
// controller to a host, which may be another machine, or this one if the controller is dummy_hcd. A
// FifoBackend is on the FPGA's side of the FIFO.
#pragma once

#include <pthread.h>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "sim/ft232h/fifo_backend.hpp"
#include "sim/ft232h/ft232h.hpp"
#include "sim/usb_gadget/function_fs.hpp"
#include "sim/usb_gadget/gadget_folder.hpp"

struct usb_ctrlrequest;

namespace fpga_stereo::sim {

/// Interrupts its threads by the signal SIGUSR2, whose handler it sets. Thread-safe.
class GadgetFt232h {
 public:
  using Options = Ft232h::Options;

  /// Creates the chip and plugs it in. The backend must outlive it. Throws std::runtime_error if
  /// this machine cannot be a USB device; the message says what is missing.
  GadgetFt232h(FifoBackend& backend, const Options& options);
  ~GadgetFt232h();
  GadgetFt232h(const GadgetFt232h&) = delete;
  GadgetFt232h& operator=(const GadgetFt232h&) = delete;

  /// Tells the chip that the backend has bytes or room.
  void poke();

  void plug();
  void unplug();
  bool is_plugged() const;
  /// Returns the name of the USB device controller.
  const std::string& controller() const { return folder_.controller(); }

  // Faults.
  /// Stalls transfers to the host until the host clears the halt.
  void stall_in();
  /// Ends the next transfers to the host with 0 bytes, even without status.
  void send_empty(int num_transfers);
  /// Limits the payload of packets, bytes; 0: to what they can hold.
  void limit_packets(std::size_t payload);

 private:
  using Lock = std::unique_lock<std::mutex>;

  /// A thread that moves bytes. The kernel blocks it while the host does not read or write.
  struct Mover {
    std::thread thread;
    bool is_blocked = false;  // perhaps, in a system call
  };

  // The three threads.
  void serve_requests();
  void send();
  void receive();

  void answer(const usb_ctrlrequest& request);
  void on_enabled();
  void fetch(Lock& lock);
  /// Moves bytes from or to a file without the lock. Returns how many, or a negative errno.
  template <class Call>
  std::int64_t block(Lock& lock, Mover& mover, const Call& call);
  /// Makes a mover leave its system call; the bytes that it holds are lost.
  void release(Lock& lock, Mover& mover);
  /// Releases both movers. They begin no other system call until the caller unlocks.
  void interrupt(Lock& lock);
  /// Blocks until poke(), interrupt() or the deadline.
  void wait(Lock& lock, Ft232h::Clock::time_point deadline);
  /// After a system call has failed in this epoch: nothing moves until the host acts.
  void wait_for_interrupt(Lock& lock, std::uint64_t epoch);
  bool wait_until_enabled(Lock& lock);
  void stop();

  FifoBackend& backend_;
  GadgetFolder folder_;
  FunctionFs files_;
  const int stop_;  // an event, for the thread that serves requests

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Ft232h chip_;
  bool is_plugged_ = false, wants_stop_ = false;
  bool is_enabled_ = false;  // the host has configured the device
  std::uint64_t epoch_ = 0;  // counts interrupt()
  int num_interrupting_ = 0;
  std::uint64_t num_pokes_ = 0;
  int num_empty_ = 0;  // transfers to end without data
  std::thread control_;
  Mover sender_, receiver_;
};

}  // namespace fpga_stereo::sim
