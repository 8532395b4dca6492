// A network of compare-exchange steps that finds the median of 25 values: Batcher's merge exchange
// sort (D. E. Knuth, "The Art of Computer Programming", vol. 3, 5.2.2, algorithm M), without the
// steps that the median does not depend on.
#pragma once

#include <array>
#include <cstddef>

namespace fpga_stereo::simd {

constexpr int kMedianTaps = 25;

/// The smaller value goes to `low`, the larger to `high`, if anything depends on them.
struct CompareExchange {
  int low, high;
  bool needs_low, needs_high;
};

struct MedianNetwork {
  std::array<CompareExchange, 200> steps{};
  std::size_t size = 0;
};

constexpr MedianNetwork make_median_network() {
  MedianNetwork sort;
  constexpr int kTop = 16;  // the largest power of 2 below kMedianTaps
  for (int p = kTop; p > 0; p /= 2) {
    int q = kTop, r = 0, distance = p;
    while (true) {
      for (int i = 0; i + distance < kMedianTaps; ++i) {
        if ((i & p) == r) sort.steps[sort.size++] = {i, i + distance, true, true};
      }
      if (q == p) break;
      distance = q - p;
      q /= 2;
      r = p;
    }
  }
  // Backwards: what do the steps after each one need?
  std::array<bool, kMedianTaps> needed{};
  needed[kMedianTaps / 2] = true;
  MedianNetwork reversed;
  for (std::size_t i = sort.size; i-- > 0;) {
    CompareExchange step = sort.steps[i];
    bool& low = needed[static_cast<std::size_t>(step.low)];
    bool& high = needed[static_cast<std::size_t>(step.high)];
    step.needs_low = low;
    step.needs_high = high;
    if (!low && !high) continue;
    low = high = true;
    reversed.steps[reversed.size++] = step;
  }
  MedianNetwork network;
  for (std::size_t i = reversed.size; i-- > 0;) network.steps[network.size++] = reversed.steps[i];
  return network;
}

constexpr MedianNetwork kMedianNetwork = make_median_network();

}  // namespace fpga_stereo::simd
