#include <algorithm>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/smooth.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/smooth.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Words = hn::CappedTag<std::uint16_t, 16>;
using Greys = hn::Rebind<std::uint8_t, Words>;

namespace {  // another file has another load()

HWY_INLINE hn::Vec<Words> load(const std::uint8_t* from) {
  return hn::PromoteTo(Words(), hn::LoadU(Greys(), from));
}
HWY_INLINE void store(hn::Vec<Words> v, std::uint8_t* to) {
  const hn::RebindToSigned<Words> d;
  hn::StoreU(hn::DemoteTo(Greys(), hn::BitCast(d, v)), Greys(), to);
}

}  // namespace

/// `in` needs a pixel on either side.
void smooth_row(const std::uint8_t* in, int width, std::uint8_t* out) {
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, std::uint16_t{2});
  for (int x = 0; x < width; x += step) {
    const auto here = load(in + x);
    const auto sides = hn::Add(load(in + x - 1), load(in + x + 1));
    store(hn::ShiftRight<2>(hn::Add(hn::Add(sides, half), hn::Add(here, here))), out + x);
  }
}

/// Returns a + 4 b + 6 c + 4 d + e.
template <class V>
HWY_INLINE V binomial(V a, V b, V c, V d, V e) {
  const V inner = hn::Add(hn::Add(b, d), c);
  return hn::Add(hn::Add(hn::Add(a, e), hn::ShiftLeft<2>(inner)), hn::Add(c, c));
}

void binomial_columns(const std::uint8_t* const rows[5], int width, std::uint16_t* out) {
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += step) {
    hn::StoreU(binomial(load(rows[0] + x), load(rows[1] + x), load(rows[2] + x), load(rows[3] + x),
                        load(rows[4] + x)),
               d, out + x);
  }
}

/// `in` needs two sums on either side. A sum is at most 16 * 255, a result 16 times that.
void binomial_row(const std::uint16_t* in, int width, std::uint8_t* out) {
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, std::uint16_t{128});
  for (int x = 0; x < width; x += step) {
    const auto at = [&](int i) HWY_ATTR { return hn::LoadU(d, in + x + i); };
    const auto sum = binomial(at(-2), at(-1), at(0), at(1), at(2));
    store(hn::ShiftRight<8>(hn::Add(sum, half)), out + x);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(smooth_row);
HWY_EXPORT(binomial_columns);
HWY_EXPORT(binomial_row);

void smooth_rows(const CensusImage& image, cv::Range rows, CensusPlanes& planes) {
  const int width = image.image.cols;
  std::vector<std::uint8_t> line(static_cast<std::size_t>(width + 2 * kBorder));
  std::uint8_t* const in = line.data() + kBorder;
  for (int y = rows.start; y < rows.end; ++y) {
    std::copy_n(image.image[y], width, in);
    in[-1] = in[0];
    in[width] = in[width - 1];
    HWY_DYNAMIC_DISPATCH(smooth_row)(in, width, planes.grey(y));
  }
}

void smooth_binomial(const CensusImage& image, cv::Range rows, GuideImage& guide) {
  const int width = image.image.cols, height = image.image.rows;
  std::vector<std::uint16_t> line(static_cast<std::size_t>(width + 2 * kBorder));
  std::uint16_t* const sums = line.data() + kBorder;
  for (int y = rows.start; y < rows.end; ++y) {
    const std::uint8_t* lines[5];
    for (int j = 0; j < 5; ++j) lines[j] = image.image[std::clamp(y + j - 2, 0, height - 1)];
    HWY_DYNAMIC_DISPATCH(binomial_columns)(lines, width, sums);
    std::fill_n(sums - 2, 2, sums[0]);
    std::fill_n(sums + width, 2, sums[width - 1]);
    HWY_DYNAMIC_DISPATCH(binomial_row)(sums, width, guide.image[y]);
  }
}

}  // namespace fpga_stereo::simd
#endif
