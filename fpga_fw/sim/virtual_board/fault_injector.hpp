// Injects faults into one direction of a line: damages single bytes and whole packets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace fpga_stereo::sim {

enum class LineFault {
  // Faults of a byte.
  kFlip,    // one bit is inverted
  kDrop,    // the byte is lost
  kInsert,  // a random byte precedes it
  kDouble,  // the byte comes twice
  // Faults of a packet.
  kLose,      // the packet is lost
  kRepeat,    // the packet comes twice
  kSwap,      // the packet follows the next one
  kTruncate,  // the end of the packet is lost
  kGarbage,   // 1 to 600 random bytes precede it
};
constexpr int kNumLineFaults = 9;
/// Returns the name of a fault, as used on the command line: "flip", "drop", ...
const char* name(LineFault fault);
/// Returns the fault with this name, or nullopt.
std::optional<LineFault> find_line_fault(const std::string& name);

/// The output depends on the input, the rates and the seed. It does not depend on how the input is
/// split into calls, unless flush() is called. Not thread-safe.
class FaultInjector {
 public:
  using Counts = std::array<std::uint64_t, kNumLineFaults>;
  /// Mean number of faults per MiB. Each fault strikes a packet at most once.
  using Rates = std::array<double, kNumLineFaults>;

  FaultInjector(const Rates& rates, std::uint64_t seed);

  /// Takes bytes and appends the result to `out`. While packet faults are possible, it holds a
  /// packet back until it is complete.
  void push(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint8_t>& out);
  /// Appends all bytes that are held back. To be called after a silence.
  void flush(std::vector<std::uint8_t>& out);
  /// Discards all bytes that are held back.
  void clear();
  /// Returns whether bytes are held back.
  bool has_pending() const { return !held_.empty() || !swapped_.empty(); }

  /// Injects `count` more faults, on average one per 4 KiB, in addition to the rates.
  void inject(LineFault fault, int count);

  /// Returns the number of faults since construction.
  const Counts& counts() const { return counts_; }

 private:
  struct Source {
    double rate = 0;
    std::mt19937_64 random;
    std::int64_t bytes_left = 0;  // until the next fault; valid if is_scheduled
    int num_injected = 0;         // by inject(), still to strike
    bool is_scheduled = false;
  };
  Source& source(LineFault fault) { return sources_[static_cast<std::size_t>(fault)]; }
  void schedule(Source& source);
  void strike(LineFault fault);
  bool has_packet_faults() const;
  void scan(std::vector<std::uint8_t>& out);
  bool strikes_packet(LineFault fault, std::size_t size);
  void pass_packet(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint8_t>& out);
  /// Applies the faults of bytes and appends the result.
  void pass(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint8_t>& out);
  void damage(LineFault fault, std::uint8_t byte, std::vector<std::uint8_t>& out);

  std::array<Source, kNumLineFaults> sources_;
  std::vector<std::uint8_t> held_;     // begins where a packet may begin
  std::vector<std::uint8_t> swapped_;  // a packet that follows the next one
  Counts counts_{};
};

}  // namespace fpga_stereo::sim
