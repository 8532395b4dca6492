#include <algorithm>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/median.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/lanes-inl.hpp"
#include "core/simd/median.hpp"
#include "core/simd/median_network.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

using Words = hn::CappedTag<std::uint16_t, 16>;
using Greys = hn::Rebind<std::uint8_t, Words>;
using VWords = hn::Vec<Words>;

/// kTaps vectors in memory, because some targets have no arrays of vectors.
template <int kTaps>
struct Taps {
  HWY_ALIGN std::uint16_t lanes[kTaps * hn::MaxLanes(Words())];

  HWY_INLINE std::uint16_t* tap(std::size_t i) { return lanes + i * hn::MaxLanes(Words()); }
  HWY_INLINE VWords get(std::size_t i) { return hn::Load(Words(), tap(i)); }
  HWY_INLINE void set(std::size_t i, VWords v) { hn::Store(v, Words(), tap(i)); }

  template <std::size_t kStep>
  HWY_INLINE void exchange() {
    constexpr CompareExchange kExchange = kMedianNetwork<kTaps>.steps[kStep];
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
    exchange_all(std::make_index_sequence<kMedianNetwork<kTaps>.size>());
    return get(kTaps / 2);
  }
};

void median_row(const std::uint16_t* const rows[5], int width, std::uint16_t* out) {
  constexpr int kSide = 2 * kMedianRadius + 1;
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  for (int x = 0; x < width; x += step) {
    Taps<kSide * kSide> taps;
    std::size_t n = 0;
    for (int j = 0; j < 5; ++j) {
      for (int i = -kMedianRadius; i <= kMedianRadius; ++i) {
        taps.set(n++, hn::LoadU(d, rows[j] + x + i));
      }
    }
    hn::StoreU(taps.median(), d, out + x);
  }
}

/// The pixels x .. of the first median. With kEdge, some taps may lie outside the image.
template <bool kEdge>
HWY_INLINE VWords masked_median_at(const MedianRows& in, int x) {
  const Words d;
  const Greys d8;
  const hn::RebindToSigned<Words> di;
  const hn::RebindToSigned<Greys> di8;
  const auto limit = hn::Set(d8, static_cast<std::uint8_t>(in.max_difference));
  const auto centre = hn::LoadU(d8, in.greys[2] + x);
  Taps<15> taps;
  // Excluded values count as the smallest and the largest in turn, so that the median of all taps
  // is that of the others.
  auto filler = hn::Zero(d);
  std::size_t n = 0;
  for (int j = 0; j < 5; ++j) {
    const bool is_row = !kEdge || in.greys[j] != nullptr;
    for (int i = -kMaskedMedianRadiusX; i <= kMaskedMedianRadiusX; i += kMaskedMedianStepX) {
      auto included = hn::Zero(d);
      auto value = filler;
      if (is_row) {
        const auto grey = hn::LoadU(d8, in.greys[j] + x + i);
        const auto excess = hn::SaturatedSub(absolute_difference(grey, centre), limit);
        const auto is_similar = hn::Eq(excess, hn::Zero(d8));
        const auto similar = hn::BitCast(di8, hn::VecFromMask(d8, is_similar));
        included = hn::BitCast(d, hn::PromoteTo(di, similar));
        value = hn::LoadU(d, in.disparities[j] + x + i);
      }
      if constexpr (kEdge) {
        // A column left of the image is a large number.
        const auto column = hn::Iota(d, static_cast<std::uint16_t>(x + i));
        const auto is_inside = hn::Lt(column, hn::Set(d, static_cast<std::uint16_t>(in.width)));
        included = hn::And(included, hn::VecFromMask(d, is_inside));
      }
      taps.set(n++, hn::IfThenElse(hn::MaskFromVec(included), value, filler));
      filler = hn::Not(hn::Xor(filler, included));
    }
  }
  return taps.median();
}

void masked_median_row(const MedianRows& in_rows, std::uint16_t* out) {
  const MedianRows in = in_rows;
  const Words d;
  const int step = static_cast<int>(hn::Lanes(d));
  bool has_all_rows = true;
  for (const std::uint8_t* grey : in.greys) has_all_rows = has_all_rows && grey != nullptr;
  for (int x = 0; x < in.width; x += step) {
    const bool is_inside =
        has_all_rows && x >= kMaskedMedianRadiusX && x + step + kMaskedMedianRadiusX <= in.width;
    hn::StoreU(is_inside ? masked_median_at<false>(in, x) : masked_median_at<true>(in, x), d,
               out + x);
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
    MedianRows lines{};
    lines.width = in.image.cols;
    lines.max_difference = p.median_difference;
    for (int j = 0; j < 5; ++j) {
      const int v = y - kMaskedMedianRadiusY + j * kMaskedMedianStepY;
      if (v < 0 || v >= height) continue;
      lines.greys[j] = left.image[v];
      lines.disparities[j] = in.image[v];
    }
    HWY_DYNAMIC_DISPATCH(masked_median_row)(lines, out.image[y]);
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
