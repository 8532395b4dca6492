#include "core/bands.hpp"

#include <algorithm>
#include <atomic>

namespace fpga_stereo {
namespace {

// Runs bands in OpenCV's threads. `order_` tells ThreadSanitizer, which does not see the
// synchronization inside OpenCV, what happens before what.
class BandLoop final : public cv::ParallelLoopBody {
 public:
  using Work = std::function<void(int, cv::Range)>;

  BandLoop(int height, int bands, const Work& work) : height_(height), bands_(bands), work_(work) {}

  void run() const {
    order_.store(0, std::memory_order_release);
    cv::parallel_for_(cv::Range(0, bands_), *this, bands_);
    order_.load(std::memory_order_acquire);
  }

  void operator()(const cv::Range& range) const override {
    order_.load(std::memory_order_acquire);
    for (int band = range.start; band < range.end; ++band) {
      work_(band, {height_ * band / bands_, height_ * (band + 1) / bands_});
    }
    order_.fetch_add(1, std::memory_order_release);
  }

 private:
  mutable std::atomic<int> order_{0};
  const int height_, bands_;
  const Work& work_;
};

}  // namespace

void for_each_band(int height, int bands, const std::function<void(int, cv::Range)>& work) {
  bands = std::min(bands, height);
  const BandLoop loop(height, bands, work);
  if (bands == 1) {
    loop({0, 1});
  } else {
    loop.run();
  }
}

}  // namespace fpga_stereo
