// Two unrelated clocks.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>

namespace fpga_stereo::test {

/// Generates the rising edges of two clocks. Times have no unit; only their ratio matters.
class TwoClocks {
 public:
  /// Takes both periods; each period is longer by a random 0 to `jitter`.
  TwoClocks(int a, int b, int jitter, unsigned seed) : period_{a, b}, jitter_(jitter) {
    random_.seed(seed);
    next_[1] = random_() % b;
  }

  /// Advances to the next edge; returns which clocks rise (bit 0, bit 1).
  int next() {
    const std::uint64_t now = std::min(next_[0], next_[1]);
    int edges = 0;
    for (int i = 0; i < 2; ++i) {
      if (next_[i] != now) continue;
      edges |= 1 << i;
      next_[i] += period_[i] + (jitter_ > 0 ? random_() % (jitter_ + 1) : 0);
    }
    return edges;
  }

  void set_periods(int a, int b) { period_[0] = a, period_[1] = b; }

 private:
  std::mt19937 random_;
  std::uint64_t next_[2] = {0, 0};
  int period_[2];
  int jitter_;
};

}  // namespace fpga_stereo::test
