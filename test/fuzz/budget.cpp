#include "fuzz/budget.hpp"

#include <sanitizer/allocator_interface.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace fpga_stereo::test {
namespace {

std::size_t allocated = 0;
bool has_hooks = false;

void on_malloc(const volatile void*, std::size_t size) { allocated += size; }
void on_free(const volatile void*) {}

double processor_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

}  // namespace

Budget::Budget(std::size_t size, const Limits& limits)
    : size_(size), limits_(limits), start_(processor_seconds()) {
  if (!has_hooks) __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
  has_hooks = true;
  allocated = 0;
}

Budget::~Budget() {
  const double size = static_cast<double>(size_);
  const double seconds = processor_seconds() - start_;
  if (seconds > limits_.seconds + limits_.seconds_per_byte * size) {
    std::fprintf(stderr, "%f s for %zu bytes\n", seconds, size_);
    std::abort();
  }
  if (allocated > limits_.bytes + limits_.bytes_per_byte * size_) {
    std::fprintf(stderr, "%zu bytes allocated for %zu bytes\n", allocated, size_);
    std::abort();
  }
}

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not so: %s\n", what);
  std::abort();
}

}  // namespace fpga_stereo::test
