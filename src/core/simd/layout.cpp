#include "core/simd/layout.hpp"

#include "core/census_window.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo::simd {

int max_census_radius() {
  static const int radius = [] {
    for (const ParameterInfo& info : parameter_table()) {
      if (info.name == "census_window_size") return static_cast<int>(info.max) / 2;
    }
    CV_Error(cv::Error::StsInternal, "the parameter table has no census_window_size");
  }();
  return radius;
}

void DisparityImage::create(cv::Size size) { BorderedImage::create(size, 0, kNoDisparity); }

void CensusPlanes::create(cv::Size size, const Parameters& p) {
  width = size.width;
  height = size.height;
  bits = static_cast<int>(census_neighbours(p).size());
  count = (bits + 7) / 8;
  margin_ = lanes_per_pixel(p.disparity_range);
  pitch = margin_ + width + kBorder;
  const int greys = p.stereo_algorithm == StereoAlgorithm::kSgm ? 1 : 0;
  bytes_.create(height, static_cast<int>(pitch) * (count + greys));
}

void SelectionBuffer::create(int width, int disparity_range) {
  const int margin = lanes_per_pixel(disparity_range);
  bytes_.create(2, margin + width + kBorder);
  words_.create(7, width + kBorder);
  bytes_ = 0;
  words_ = 0;
  row_ = {width,     bytes_[0] + margin, bytes_[1] + margin,
          words_[0], words_[1],          {words_[2], words_[3], words_[4], words_[5], words_[6]}};
}

}  // namespace fpga_stereo::simd
