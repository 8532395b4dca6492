// What one run of a fuzzer may cost.
#pragma once

#include <cstddef>

namespace fpga_stereo::test {

/// Aborts, when it goes out of scope, if the code since its construction has taken more processor
/// time or allocated more memory than `size` bytes of input allow. Allocations are summed up, freed
/// or not, so they also measure work.
class Budget {
 public:
  struct Limits {
    double seconds = 0.05, seconds_per_byte = 20e-6;  // sanitizers make the code slow
    std::size_t bytes = 1 << 20, bytes_per_byte = 1024;
  };
  Budget(std::size_t size, const Limits& limits);
  explicit Budget(std::size_t size) : Budget(size, Limits()) {}
  ~Budget();
  Budget(const Budget&) = delete;
  Budget& operator=(const Budget&) = delete;

 private:
  const std::size_t size_;
  const Limits limits_;
  const double start_;
};

/// Aborts if the condition is false; `what` is printed.
void require(bool condition, const char* what);

}  // namespace fpga_stereo::test
