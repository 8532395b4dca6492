#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/match.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D8 = hn::CappedTag<std::uint8_t, kLaneGroup>;
using V8 = hn::Vec<D8>;
using D16 = hn::CappedTag<std::uint16_t, kLaneGroup>;
using V16 = hn::Vec<D16>;

#if HWY_TARGET == HWY_AVX3_DL
constexpr bool kCountsBits = true;
#else
constexpr bool kCountsBits = false;
#endif

/// Sums of three bits: of weight 1 and 2.
struct Sum {
  V8 ones, twos;
};
HWY_INLINE Sum add_bits(V8 a, V8 b, V8 c) {
  const V8 half = hn::Xor(a, b);
  return {hn::Xor(half, c), hn::Or(hn::And(a, b), hn::And(half, c))};
}

/// Bits set in kCount bytes per lane. Where counting is dear, a tree of adders comes first
/// (H. S. Warren, "Hacker's Delight", 5-1).
template <std::size_t kCount>
HWY_INLINE V8 count_bits(const std::array<V8, kCount>& bytes) {
  const D8 d;
  if constexpr (kCount == 0) {
    return hn::Zero(d);
  } else if constexpr (kCountsBits || kCount < 3) {
    V8 sum = hn::PopulationCount(bytes[0]);
    for (std::size_t k = 1; k < kCount; ++k) sum = hn::Add(sum, hn::PopulationCount(bytes[k]));
    return sum;
  } else {
    constexpr std::size_t kSums = (kCount - 1) / 2;
    std::array<V8, kSums> twos;
    V8 ones = bytes[0];
    for (std::size_t k = 0; k < kSums; ++k) {
      const Sum sum = add_bits(ones, bytes[2 * k + 1], bytes[2 * k + 2]);
      ones = sum.ones;
      twos[k] = sum.twos;
    }
    V8 rest = hn::PopulationCount(ones);
    if constexpr (kCount % 2 == 0) rest = hn::Add(rest, hn::PopulationCount(bytes[kCount - 1]));
    const V8 pairs = count_bits<kSums>(twos);
    return hn::Add(rest, hn::Add(pairs, pairs));
  }
}

/// columns += entering - leaving, each of which is at most 120.
HWY_INLINE void change(V8 entering, V8 leaving, std::int16_t* columns) {
  const hn::RebindToSigned<D8> d8s;
  const auto difference = hn::BitCast(d8s, hn::Sub(entering, leaving));
#if HWY_MAX_BYTES >= 64
  const hn::Rebind<std::int16_t, D8> d16;
  hn::StoreU(hn::Add(hn::LoadU(d16, columns), hn::PromoteTo(d16, difference)), d16, columns);
#else
  const hn::Half<decltype(d8s)> half;
  const hn::Rebind<std::int16_t, decltype(half)> d16;
  const auto lower = hn::PromoteTo(d16, hn::LowerHalf(half, difference));
  const auto upper = hn::PromoteTo(d16, hn::UpperHalf(half, difference));
  std::int16_t* second = columns + hn::Lanes(d16);
  hn::StoreU(hn::Add(hn::LoadU(d16, columns), lower), d16, columns);
  hn::StoreU(hn::Add(hn::LoadU(d16, second), upper), d16, second);
#endif
}

template <std::size_t kPlanes, int kGroups>
HWY_INLINE void hamming_planes(const HammingRow& row, int x0, int x1, std::uint8_t* slot,
                               std::int16_t* columns) {
  const D8 d;
  const int padded = kGroups > 0 ? kGroups * kLaneGroup : row.padded;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, static_cast<std::uint8_t>(row.half));
  const auto number = hn::Iota(d, std::uint8_t{0});
  const int outside = padded - row.range;  // the first lanes
  for (int x = x0; x < x1; ++x) {
    std::array<V8, kPlanes> left;
    for (std::size_t k = 0; k < kPlanes; ++k) {
      left[k] = hn::Set(d, row.left[static_cast<std::ptrdiff_t>(k) * row.plane_pitch + x]);
    }
    const std::uint8_t* right = row.right + x - (padded - 1);
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * padded;
    const int unseen = padded - 1 - x;  // the first lanes, if any
    for (int i = 0; i < padded; i += lanes) {
      std::array<V8, kPlanes> differing;
      for (std::size_t k = 0; k < kPlanes; ++k) {
        const std::uint8_t* plane = right + static_cast<std::ptrdiff_t>(k) * row.plane_pitch;
        differing[k] = hn::Xor(left[k], hn::LoadU(d, plane + i));
      }
      V8 distance = count_bits<kPlanes>(differing);
      if (HWY_UNLIKELY(i < unseen)) {
        const auto last = hn::Set(d, static_cast<std::uint8_t>(std::min(unseen - i, lanes)));
        distance = hn::IfThenElse(hn::Lt(number, last), half, distance);
      }
      if (HWY_UNLIKELY(i < outside)) {
        const auto last = hn::Set(d, static_cast<std::uint8_t>(std::min(outside - i, lanes)));
        distance = hn::IfThenZeroElse(hn::Lt(number, last), distance);
      }
      change(distance, hn::LoadU(d, slot + at + i), columns + at + i);
      hn::StoreU(distance, d, slot + at + i);
    }
  }
}

template <std::size_t kPlanes>
HWY_INLINE void hamming_groups(const HammingRow& row, int x0, int x1, std::uint8_t* slot,
                               std::int16_t* columns) {
  switch (row.padded / kLaneGroup) {
    case 2:
      return hamming_planes<kPlanes, 2>(row, x0, x1, slot, columns);
    case 4:
      return hamming_planes<kPlanes, 4>(row, x0, x1, slot, columns);
    default:
      return hamming_planes<kPlanes, 0>(row, x0, x1, slot, columns);
  }
}

void hamming(const HammingRow& row, int x0, int x1, std::uint8_t* slot, std::int16_t* columns) {
  // The number of planes that a census of this window and pattern has.
  switch (row.planes) {
    case 1:
      return hamming_groups<1>(row, x0, x1, slot, columns);
    case 3:
      return hamming_groups<3>(row, x0, x1, slot, columns);
    case 6:
      return hamming_groups<6>(row, x0, x1, slot, columns);
    case 10:
      return hamming_groups<10>(row, x0, x1, slot, columns);
    default:
      return hamming_groups<15>(row, x0, x1, slot, columns);
  }
}

void leave(int padded, int x0, int x1, std::uint8_t* slot, std::int16_t* columns) {
  const D8 d;
  const std::ptrdiff_t end = static_cast<std::ptrdiff_t>(x1) * padded;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(x0) * padded; i < end; i += lanes) {
    change(hn::Zero(d), hn::LoadU(d, slot + i), columns + i);
    hn::StoreU(hn::Zero(d), d, slot + i);
  }
}

void box(const std::int16_t* columns, int radius, int x0, int x1, const SumRing& sums) {
  constexpr std::size_t kParts = kLaneGroup / hn::MaxLanes(D16());
  const D16 d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const auto* from = reinterpret_cast<const std::uint16_t*>(columns);
  const std::ptrdiff_t window = static_cast<std::ptrdiff_t>(2 * radius + 1) * sums.padded;
  // A group of disparities of all columns, then the next: the sums stay in registers.
  for (int i = 0; i < sums.padded; i += kLaneGroup) {
    const std::uint16_t* before = sums.row(x0 - 1) + i;
    const std::uint16_t* entering =
        from + static_cast<std::ptrdiff_t>(x0 + radius) * sums.padded + i;
    std::uint16_t* out = sums.row(x0) + i;
    std::array<V16, kParts> sum;
    for (std::size_t k = 0; k < kParts; ++k) sum[k] = hn::LoadU(d, before + k * lanes);
    for (int x = x0; x < x1; ++x, entering += sums.padded, out += sums.pitch) {
      for (std::size_t k = 0; k < kParts; ++k) {
        const std::uint16_t* next = entering + k * lanes;
        sum[k] = hn::Add(sum[k], hn::Sub(hn::LoadU(d, next), hn::LoadU(d, next - window)));
        hn::StoreU(sum[k], d, out + k * lanes);
      }
    }
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(hamming);
HWY_EXPORT(leave);
HWY_EXPORT(box);

void hamming(const HammingRow& row, int x0, int x1, std::uint8_t* slot, std::int16_t* columns) {
  HWY_DYNAMIC_DISPATCH(hamming)(row, x0, x1, slot, columns);
}
void leave(int padded, int x0, int x1, std::uint8_t* slot, std::int16_t* columns) {
  HWY_DYNAMIC_DISPATCH(leave)(padded, x0, x1, slot, columns);
}
void box(const std::int16_t* columns, int radius, int x0, int x1, const SumRing& sums) {
  HWY_DYNAMIC_DISPATCH(box)(columns, radius, x0, x1, sums);
}

}  // namespace fpga_stereo::simd
#endif
