#include <algorithm>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/census.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/census_window.hpp"
#include "core/simd/stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Census of a row. `neighbours` are distances from a pixel in bytes.
void census_row(const std::uint8_t* image, int width, const std::vector<std::ptrdiff_t>& neighbours,
                std::uint8_t* planes, std::ptrdiff_t plane_pitch) {
  const hn::CappedTag<std::uint8_t, kBorder> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const std::size_t count = neighbours.size();
  for (int x = 0; x < width; x += lanes) {
    const auto centre = hn::LoadU(d, image + x);
    std::uint8_t* out = planes + x;
    for (std::size_t first = 0; first < count; first += 8, out += plane_pitch) {
      auto bits = hn::Zero(d);
      for (std::size_t k = std::min(first + 8, count); k-- > first;) {
        const auto smaller = hn::Lt(hn::LoadU(d, image + x + neighbours[k]), centre);
        bits = hn::Sub(hn::Add(bits, bits), hn::VecFromMask(d, smaller));
      }
      hn::StoreU(bits, d, out);
    }
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(census_row);

void census(const CensusImage& image, const Parameters& p, cv::Range rows, CensusPlanes& bits) {
  const auto pitch = static_cast<std::ptrdiff_t>(image.image.step[0]);
  std::vector<std::ptrdiff_t> neighbours;
  for (const cv::Point& n : census_neighbours(p)) neighbours.push_back(n.y * pitch + n.x);
  for (int y = rows.start; y < rows.end; ++y) {
    HWY_DYNAMIC_DISPATCH(census_row)
    (image.image[y], image.image.cols, neighbours, bits.row(y), bits.pitch);
  }
}

}  // namespace fpga_stereo::simd
#endif
