// What a line does to bytes on their way, on demand: single bytes and whole packets are damaged.
// One injector is one direction of a line.
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
  kFlip,    // a bit
  kDrop,    // a byte is lost
  kInsert,  // a random byte comes in between
  kDouble,  // a byte comes twice
  // Of packets.
  kLose,      // one is lost
  kRepeat,    // one comes twice
  kSwap,      // one comes behind the next
  kTruncate,  // one lacks its end
  kGarbage,   // 1 to 600 random bytes before one
};
constexpr int kNumLineFaults = 9;
/// As on the command line: "flip", "drop", ...
const char* name(LineFault fault);
std::optional<LineFault> line_fault(const std::string& name);

/// What comes out depends on what went in, on rates and seed; not on how it was split, as long as
/// flush() is not called.
class FaultInjector {
 public:
  using Counts = std::array<std::uint64_t, kNumLineFaults>;
  /// Faults per MiB, on average; those of packets at most once each.
  using Rates = std::array<double, kNumLineFaults>;

  FaultInjector(const Rates& rates, std::uint64_t seed);

  /// Bytes that go in; what comes out is appended to `out`. A packet waits for its end where one
  /// may be damaged as a whole.
  void push(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint8_t>& out);
  /// Nothing has come for a while: what waits comes out.
  void flush(std::vector<std::uint8_t>& out);
  /// The line was cut: what waits is lost.
  void clear();
  bool waiting() const { return !held_.empty() || !swapped_.empty(); }

  /// So many of these, beside the rates, among the next bytes: one in 4 KiB on average.
  void inject(LineFault fault, int count);

  /// What was done since the start.
  const Counts& counts() const { return counts_; }

 private:
  struct Source {
    double rate = 0;
    std::mt19937_64 random;
    std::int64_t left = 0;   // bytes up to the next fault
    int extra = 0;           // of inject()
    bool scheduled = false;  // `left` means something
  };
  Source& source(LineFault fault) { return sources_[static_cast<std::size_t>(fault)]; }
  void schedule(Source& source);
  void strike(LineFault fault);
  bool packets_at_risk() const;
  void scan(std::vector<std::uint8_t>& out);
  bool strikes_packet(LineFault fault, std::size_t size);
  void packet(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint8_t>& out);
  /// The faults of bytes, and out.
  void pass(const std::uint8_t* bytes, std::size_t size, std::vector<std::uint8_t>& out);
  void damage(LineFault fault, std::uint8_t byte, std::vector<std::uint8_t>& out);

  std::array<Source, kNumLineFaults> sources_;
  std::vector<std::uint8_t> held_;     // from the start of what may be a packet
  std::vector<std::uint8_t> swapped_;  // a packet that waits for the next
  Counts counts_{};
};

}  // namespace fpga_stereo::sim
