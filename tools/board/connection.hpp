// A board that is open while a mode works with it.
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

/// --wait and --verbose.
struct Patience {
  double seconds = 3;    // for a board that does not answer
  bool verbose = false;  // what happens on the line, on stderr
};
void add_patience(boost::program_options::options_description& options);
Patience patience(const boost::program_options::variables_map& options);

/// open_transport(); throws: UsageError for a name that is none.
std::unique_ptr<link::Transport> open_line(const std::string& device);

class Connection {
 public:
  using Snapshot = link::Device::Snapshot;
  struct Arrived {
    link::ReceivedFrames frames;
    double at = 0;  // s, host
  };
  /// Wraps each transport that is opened.
  using Wrap =
      std::function<Result<std::unique_ptr<link::Transport>>(std::unique_ptr<link::Transport>)>;

  /// Opens the line; throws where that does not succeed at once. Later it is opened whenever it is
  /// lost.
  Connection(const std::string& device, const Patience& patience, const Wrap& wrap = nullptr);

  /// Waits for a board that this software works with; throws with why there is none.
  link::Identity identify();
  void want(const link::DesiredState& wanted) { device_->set_desired_state(wanted); }
  /// Until `done`; false: not within `seconds`. Throws if the board is refused, or interrupted().
  bool wait_until(double seconds, const std::function<bool(const Snapshot&)>& done);
  /// What has come since the last call; waits for some.
  std::vector<Arrived> take(std::chrono::milliseconds timeout);
  /// Values of registers, in this order. What the line loses is asked for again; throws.
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
  std::unique_ptr<link::Device> device_;  // the last: it calls back
};

}  // namespace fpga_stereo::tools
