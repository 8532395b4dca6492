// Lines for the tests of transports: devices at the far end that can be fed, held and unplugged.
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

/// A thread-safe queue of bytes.
class Wire {
 public:
  void push(const std::uint8_t* bytes, std::size_t size);
  std::size_t pop(std::uint8_t* bytes, std::size_t size);
  /// Takes `size` bytes; blocks until they have arrived. Returns fewer after five seconds without
  /// any.
  Bytes wait(std::size_t size);
  std::size_t size() const;
  void clear();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Bytes bytes_;
  std::size_t at_ = 0;  // first byte not taken yet
};

/// A device and the line to it; plugged in at first.
class Line {
 public:
  virtual ~Line() = default;
  virtual Result<std::unique_ptr<link::Transport>> open() = 0;
  /// Sends bytes to the host without blocking.
  virtual void send(const Bytes& bytes) = 0;
  /// Takes bytes from the host; blocks as Wire::wait() does.
  virtual Bytes take(std::size_t size) = 0;
  /// Lets the device accept or refuse bytes of the host.
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
