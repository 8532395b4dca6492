#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/median.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/median.hpp"
#include "core/simd/median_network.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Words = hn::CappedTag<std::uint16_t, 16>;
using Greys = hn::Rebind<std::uint8_t, Words>;
using VWords = hn::Vec<Words>;

/// kMedianTaps vectors in memory: there are no arrays of vectors whose size is known at run time.
struct Taps {
  HWY_ALIGN std::uint16_t lanes[kMedianTaps * hn::MaxLanes(Words())];

  HWY_INLINE std::uint16_t* tap(std::size_t i) { return lanes + i * hn::MaxLanes(Words()); }
  HWY_INLINE VWords get(std::size_t i) { return hn::Load(Words(), tap(i)); }
  HWY_INLINE void set(std::size_t i, VWords v) { hn::Store(v, Words(), tap(i)); }

  template <std::size_t kStep>
  HWY_INLINE void exchange() {
    constexpr CompareExchange kExchange = kMedianNetwork.steps[kStep];
    constexpr auto kLow = static_cast<std::size_t>(kExchange.low);
    constexpr auto kHigh = static_cast<std::size_t>(kExchange.high);
    const VWords a = get(kLow), b = get(kHigh);
    if constexpr (kExchange.needs_low) set(kLow, hn::Min(a, b));
    if constexpr (kExchange.needs_high) set(kHigh, hn::Max(a, b));
  }
  template <std::size_t... kSteps>
  HWY_INLINE void exchange_all(std::index_sequence<kSteps...> /*steps*/) {
    (exchange<kSteps>(), ...);
  }
  HWY_INLINE VWords median() {
    exchange_all(std::make_index_sequence<kMedianNetwork.size>());
    return get(kMedianTaps / 2);
  }
};

void median_row(const std::uint16_t* const rows[5], int width, std::uint16_t* out) {
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += step) {
    Taps taps;
    std::size_t n = 0;
    for (int j = 0; j < 5; ++j) {
      for (int i = -kMedianRadius; i <= kMedianRadius; ++i) {
        taps.set(n++, hn::LoadU(d, rows[j] + x + i));
      }
    }
    hn::StoreU(taps.median(), d, out + x);
  }
}

/// greys[j] and rows[j] are those of row -4, -2, 0, 2, 4 of the window, null outside the image.
void masked_median_row(const std::uint8_t* const greys[5], const std::uint16_t* const rows[5],
                       int max_difference, int width, std::uint16_t* out) {
  const Words d;
  const Greys d8;
  const hn::RebindToSigned<Words> di;
  const hn::RebindToSigned<Greys> di8;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto limit = hn::Set(d8, static_cast<std::uint8_t>(max_difference));
  const auto number = hn::Iota(d, std::uint16_t{0});
  for (int x = 0; x < width; x += step) {
    const auto centre = hn::LoadU(d8, greys[2] + x);
    Taps taps;
    // Excluded values count as the smallest and the largest in turn, so that the median of all taps
    // is that of the others.
    auto filler = hn::Zero(d);
    std::size_t n = 0;
    for (int j = 0; j < 5; ++j) {
      for (int i = -kMaskedMedianRadiusX; i <= kMaskedMedianRadiusX; i += kMaskedMedianStepX) {
        auto included = hn::Zero(d);
        auto value = filler;
        if (greys[j] != nullptr) {
          const auto grey = hn::LoadU(d8, greys[j] + x + i);
          const auto difference =
              hn::Or(hn::SaturatedSub(grey, centre), hn::SaturatedSub(centre, grey));
          const auto is_similar = hn::Eq(hn::SaturatedSub(difference, limit), hn::Zero(d8));
          const auto similar = hn::BitCast(di8, hn::VecFromMask(d8, is_similar));
          included = hn::BitCast(d, hn::PromoteTo(di, similar));
          value = hn::LoadU(d, rows[j] + x + i);
        }
        if (x + i < 0 || x + i + step > width) {
          const auto column =
              hn::Add(number, hn::Set(d, static_cast<std::uint16_t>(x + i)));  // < 0: large
          const auto is_inside = hn::Lt(column, hn::Set(d, static_cast<std::uint16_t>(width)));
          included = hn::And(included, hn::VecFromMask(d, is_inside));
        }
        taps.set(n++, hn::IfThenElse(hn::MaskFromVec(included), value, filler));
        filler = hn::Not(hn::Xor(filler, included));
      }
    }
    hn::StoreU(taps.median(), d, out + x);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(median_row);
HWY_EXPORT(masked_median_row);

void masked_median(const CensusImage& left, const DisparityImage& in, const Parameters& p,
                   cv::Range rows, DisparityImage& out) {
  const int height = in.image.rows;
  for (int y = rows.start; y < rows.end; ++y) {
    const std::uint8_t* greys[5];
    const std::uint16_t* disparities[5];
    for (int j = 0; j < 5; ++j) {
      const int v = y - kMaskedMedianRadiusY + j * kMaskedMedianStepY;
      const bool is_inside = v >= 0 && v < height;
      greys[j] = is_inside ? left.image[v] : nullptr;
      disparities[j] = is_inside ? in.image[v] : nullptr;
    }
    HWY_DYNAMIC_DISPATCH(masked_median_row)
    (greys, disparities, p.median_difference, in.image.cols, out.image[y]);
  }
}

void median(const DisparityImage& in, cv::Range rows, DisparityImage& out) {
  const int height = in.image.rows, width = in.image.cols;
  for (int y = rows.start; y < rows.end; ++y) {
    const std::uint16_t* lines[5];
    for (int j = 0; j < 5; ++j) {
      lines[j] = in.image[std::clamp(y + j - kMedianRadius, 0, height - 1)];
    }
    HWY_DYNAMIC_DISPATCH(median_row)(lines, width, out.image[y]);
  }
}

void replicate_columns(DisparityImage& image, cv::Range rows) {
  const int width = image.image.cols;
  for (int y = rows.start; y < rows.end; ++y) {
    std::uint16_t* row = image.image[y];
    std::fill_n(row - kMedianRadius, kMedianRadius, row[0]);
    std::fill_n(row + width, kMedianRadius, row[width - 1]);
  }
}

}  // namespace fpga_stereo::simd
#endif
