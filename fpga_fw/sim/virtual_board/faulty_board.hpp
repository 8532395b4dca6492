// A board behind a line that damages, delays and breaks off. Everything happens in the board's own
// time: the same calls give the same bytes.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "sim/virtual_board/board.hpp"
#include "sim/virtual_board/fault_injector.hpp"

namespace fpga_stereo::sim {

/// Thread-safe: the line may be served by one thread, the cameras by another.
class FaultyBoard : public Board {
 public:
  struct Options {
    FaultInjector::Rates to_host{}, from_host{};
    std::uint64_t seed = 1;
    double bytes_per_s = 0;  // that the host takes; 0: as many as it likes
  };
  /// Since the start.
  struct Counts {
    std::uint64_t pairs = 0;                   // that the cameras delivered
    std::uint64_t to_host = 0, from_host = 0;  // bytes on the line
    std::uint64_t lost = 0;                    // bytes for a host that did not listen
    std::uint64_t stalls = 0, resets = 0;
    FaultInjector::Counts faults_to_host{}, faults_from_host{};
  };

  FaultyBoard(std::unique_ptr<Board> board, const Options& options);

  void reset() override;
  std::size_t receive(const std::uint8_t* bytes, std::size_t size) override;
  std::size_t transmit(std::uint8_t* bytes, std::size_t size) override;
  void feed(const GreyPair& pair) override;
  void run(std::chrono::microseconds time) override;

  /// So many faults of a kind among the next bytes.
  void inject(bool to_host, LineFault fault, int count);
  /// Nothing passes, for so long.
  void stall(std::chrono::microseconds time);
  /// The board is reset in the middle of what it sends next; after a second without any, then.
  void reset_soon();
  /// Nobody listens: what waits for the host is lost.
  void discard();
  /// The cable was pulled: what is on the way is lost, too.
  void cut();
  Counts counts() const;

 private:
  bool stalled() const { return stalled_.count() > 0; }
  std::size_t fetch(std::size_t size);
  void deliver();
  void reset_board();

  mutable std::mutex mutex_;
  const std::unique_ptr<Board> board_;
  const Options options_;
  FaultInjector to_host_, from_host_;
  std::vector<std::uint8_t> out_, in_;  // behind the faults, not yet taken
  std::size_t out_at_ = 0;
  double allowance_ = 0;  // bytes that the host takes now
  std::chrono::microseconds stalled_{0}, silence_out_{0}, silence_in_{0}, reset_in_{0};
  Counts counts_;
};

}  // namespace fpga_stereo::sim
