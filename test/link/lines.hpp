// Lines for the tests of transports: the far end, and what happens to it.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "fpga_stereo/link/transport.hpp"
#include "link/faults.hpp"

namespace fpga_stereo::test {

/// Bytes on their way, for two threads.
class Wire {
 public:
  void push(const std::uint8_t* bytes, std::size_t size);
  std::size_t pop(std::uint8_t* bytes, std::size_t size);
  /// `size` bytes, once they have come; fewer after five seconds without.
  Bytes wait(std::size_t size);
  std::size_t size() const;
  void clear();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Bytes bytes_;
  std::size_t at_ = 0;  // the first that has not been taken
};

/// A device and the line to it, plugged in.
class Line {
 public:
  virtual ~Line() = default;
  virtual Result<std::unique_ptr<link::Transport>> open() = 0;
  /// To the host; does not wait.
  virtual void send(const Bytes& bytes) = 0;
  /// From the host: as Wire::wait().
  virtual Bytes take(std::size_t size) = 0;
  /// Whether the device takes what the host sends.
  virtual void listen(bool on) = 0;
  virtual void unplug() = 0;
  virtual void plug() = 0;
};

struct LineKind {
  std::string name;
  std::function<std::unique_ptr<Line>()> make;
  bool exclusive = true;  // a second open() is refused
};
void PrintTo(const LineKind& kind, std::ostream* out);

std::unique_ptr<Line> make_memory_line();
std::unique_ptr<Line> make_pty_line();

}  // namespace fpga_stereo::test
