// Networks of compare-exchange steps that find a median: Batcher's merge exchange sort (D. E.
// Knuth, "The Art of Computer Programming", vol. 3, 5.2.2, algorithm M), without the steps that the
// median does not depend on.
#pragma once

#include <array>
#include <cstddef>

namespace fpga_stereo::simd {

/// The smaller value goes to `low`, the larger to `high`, if anything depends on them.
struct CompareExchange {
  int low, high;
  bool needs_low, needs_high;
};

struct MedianNetwork {
  std::array<CompareExchange, 200> steps{};
  std::size_t size = 0;
};

/// Returns the network for an odd number of values, at least 3 and at most 25.
constexpr MedianNetwork make_median_network(int taps) {
  MedianNetwork sort;
  int top = 1;  // the largest power of 2 below `taps`
  while (2 * top < taps) top *= 2;
  for (int p = top; p > 0; p /= 2) {
    int q = top, r = 0, distance = p;
    while (true) {
      for (int i = 0; i + distance < taps; ++i) {
        if ((i & p) == r) sort.steps[sort.size++] = {i, i + distance, true, true};
      }
      if (q == p) break;
      distance = q - p;
      q /= 2;
      r = p;
    }
  }
  // Backwards: what do the steps after each one need?
  std::array<bool, 25> needed{};
  needed[static_cast<std::size_t>(taps / 2)] = true;
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

template <int kTaps>
constexpr MedianNetwork kMedianNetwork = make_median_network(kTaps);

}  // namespace fpga_stereo::simd
