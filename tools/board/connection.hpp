// The connection of a mode to a board.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "fpga_stereo/link/device.hpp"
#include "support/program.hpp"

namespace fpga_stereo::tools {

/// The options --wait and --verbose.
struct Patience {
  double seconds = 3;    // timeout for answers of the board
  bool verbose = false;  // report events of the link on stderr
};
/// Adds DEVICE, --device, --wait and --verbose.
void add_patience(CommandLine& line);
/// Returns the device that was given, or the default.
std::string device_of(const Parsed& parsed);
Patience patience(const boost::program_options::variables_map& options);

/// Opens a transport. Throws UsageError for an invalid name and std::runtime_error for other
/// errors.
std::unique_ptr<link::Transport> open_line(const std::string& device);

/// The functions are called by one thread; frames arrive on the thread of the device.
class Connection {
 public:
  using Snapshot = link::Device::Snapshot;
  struct Arrived {
    link::ReceivedFrames frames;
    double at = 0;  // arrival, s, host clock
  };
  /// Wraps each transport that is opened.
  using Wrap =
      std::function<Result<std::unique_ptr<link::Transport>>(std::unique_ptr<link::Transport>)>;

  /// Opens the transport; throws if that fails. If it is lost later, the device reopens it.
  Connection(const std::string& device, const Patience& patience, const Wrap& wrap = nullptr);

  /// Waits for a compatible board. Throws an error with the reason if none answers.
  link::Identity identify();
  void set_desired_state(const link::DesiredState& state) { device_->set_desired_state(state); }
  /// Blocks until `done` returns true. Returns false after `seconds`. Throws if the board is
  /// refused or the program interrupted.
  bool wait_until(double seconds, const std::function<bool(const Snapshot&)>& done);
  /// Returns the frames that arrived since the last call; blocks until some arrive or the timeout
  /// expires.
  std::vector<Arrived> take(std::chrono::milliseconds timeout);
  /// Returns the values of registers, in this order. Repeats requests that the link loses; throws
  /// if the board does not answer in time.
  std::vector<std::uint32_t> read(const std::vector<std::uint32_t>& addresses);
  void write(const std::vector<RegisterWrite>& writes);

  link::Device& device() { return *device_; }
  Snapshot snapshot() const { return device_->snapshot(); }
  double patience() const { return patience_.seconds; }

 private:
  /// Calls `ask` until it succeeds or the patience ends.
  template <class Ask>
  auto retry(const Ask& ask);
  [[noreturn]] void fail(const std::string& why) const;

  const std::string name_;
  const Patience patience_;
  std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Arrived> arrived_;
  std::unique_ptr<link::Device> device_;  // last, because its callbacks use the other members
};

}  // namespace fpga_stereo::tools
