// Random decisions for streams that stall at random.
#pragma once

#include <random>

namespace fpga_stereo::sim {

/// Returns true with a fixed probability.
class Chance {
 public:
  Chance(double probability, unsigned seed)
      : random_(seed), limit_(probability * std::mt19937::max()) {}
  bool operator()() { return random_() <= limit_; }

 private:
  std::mt19937 random_;
  double limit_;
};

}  // namespace fpga_stereo::sim
