#include "core/bands.hpp"

#include <algorithm>

namespace fpga_stereo {

void for_each_band(int height, int bands, const std::function<void(int, cv::Range)>& work) {
  bands = std::min(bands, height);
  const auto band_rows = [&](int band) {
    return cv::Range(height * band / bands, height * (band + 1) / bands);
  };
  const auto run = [&](const cv::Range& range) {
    for (int band = range.start; band < range.end; ++band) work(band, band_rows(band));
  };
  if (bands == 1) return run({0, 1});
  cv::parallel_for_(cv::Range(0, bands), run, bands);
}

}  // namespace fpga_stereo
