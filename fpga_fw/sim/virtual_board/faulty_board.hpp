// Puts a virtual board behind a faulty line: one that damages, delays and interrupts. It is
// deterministic, because all delays are in the board's own time.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "sim/virtual_board/board.hpp"
#include "sim/virtual_board/fault_injector.hpp"

namespace fpga_stereo::sim {

/// Thread-safe: one thread may serve the line and another the cameras.
class FaultyBoard : public Board {
 public:
  struct Options {
    FaultInjector::Rates to_host{}, from_host{};
    std::uint64_t seed = 1;
    double bytes_per_s = 0;  // maximum rate to the host; 0: unlimited
  };
  /// Totals since construction.
  struct Counts {
    std::uint64_t pairs = 0;                   // delivered by the cameras
    std::uint64_t to_host = 0, from_host = 0;  // bytes carried
    std::uint64_t lost = 0;                    // bytes to the host that were discarded
    std::uint64_t stalls = 0, resets = 0;
    FaultInjector::Counts faults_to_host{}, faults_from_host{};
  };

  FaultyBoard(std::unique_ptr<Board> board, const Options& options);

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  void feed(const GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

  /// Injects `count` faults among the next bytes in one direction.
  void inject(bool to_host, LineFault fault, int count);
  /// Carries nothing for `time`.
  void stall(std::chrono::microseconds time);
  /// Resets the board in the middle of the bytes that it sends next, or after a second without any.
  void reset_soon();
  /// Discards the bytes that wait for the host. To be called while no host is connected.
  void discard();
  /// Discards the bytes that wait in both directions, as if the cable was pulled.
  void cut();
  Counts counts() const;

 private:
  bool is_stalled() const { return stall_time_.count() > 0; }
  std::size_t fetch(std::size_t size);
  void deliver();
  void reset_board();

  mutable std::mutex mutex_;
  const std::unique_ptr<Board> board_;
  const Options options_;
  FaultInjector to_host_, from_host_;
  std::vector<std::uint8_t> out_, in_;  // behind the fault injectors, not yet taken
  std::size_t out_at_ = 0;              // bytes of out_ that the host has taken
  double allowance_ = 0;                // bytes that the rate limit permits now
  std::chrono::microseconds stall_time_{0}, silence_out_{0}, silence_in_{0}, reset_in_{0};
  Counts counts_;
};

}  // namespace fpga_stereo::sim
