#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/census.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

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

void census_row(const std::uint8_t* image, int width, const std::vector<std::ptrdiff_t>& neighbours,
                std::uint8_t* planes, std::ptrdiff_t plane_pitch) {
  HWY_DYNAMIC_DISPATCH(census_row)(image, width, neighbours, planes, plane_pitch);
}

}  // namespace fpga_stereo::simd
#endif
