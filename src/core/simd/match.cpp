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

using Group = hn::CappedTag<std::uint8_t, kLaneGroup>;
using TwoGroups = hn::CappedTag<std::uint8_t, std::size_t{2} * kLaneGroup>;
using D16 = hn::CappedTag<std::uint16_t, kLaneGroup>;
using V16 = hn::Vec<D16>;

#if HWY_TARGET == HWY_AVX3_DL
constexpr bool kCountsBits = true;
#else
constexpr bool kCountsBits = false;
#endif

/// kParts vectors side by side: what is the same for all of them is loaded once.
template <class D, std::size_t kParts>
struct Wide {
  std::array<hn::Vec<D>, kParts> parts;
};
template <class D, std::size_t kParts, class Operation>
HWY_INLINE Wide<D, kParts> each(const Wide<D, kParts>& a, const Wide<D, kParts>& b,
                                const Operation& operation) {
  Wide<D, kParts> result;
  for (std::size_t k = 0; k < kParts; ++k) result.parts[k] = operation(a.parts[k], b.parts[k]);
  return result;
}
template <class D, std::size_t kParts>
HWY_INLINE Wide<D, kParts> operator^(const Wide<D, kParts>& a, const Wide<D, kParts>& b) {
  return each(a, b, [](auto x, auto y) HWY_ATTR { return hn::Xor(x, y); });
}
template <class D, std::size_t kParts>
HWY_INLINE Wide<D, kParts> operator&(const Wide<D, kParts>& a, const Wide<D, kParts>& b) {
  return each(a, b, [](auto x, auto y) HWY_ATTR { return hn::And(x, y); });
}
template <class D, std::size_t kParts>
HWY_INLINE Wide<D, kParts> operator|(const Wide<D, kParts>& a, const Wide<D, kParts>& b) {
  return each(a, b, [](auto x, auto y) HWY_ATTR { return hn::Or(x, y); });
}
template <class D, std::size_t kParts>
HWY_INLINE Wide<D, kParts> operator+(const Wide<D, kParts>& a, const Wide<D, kParts>& b) {
  return each(a, b, [](auto x, auto y) HWY_ATTR { return hn::Add(x, y); });
}
template <class D, std::size_t kParts>
HWY_INLINE Wide<D, kParts> population(const Wide<D, kParts>& a) {
  return each(a, a, [](auto x, auto /*y*/) HWY_ATTR { return hn::PopulationCount(x); });
}

/// Adders of vectors of bits (H. S. Warren, "Hacker's Delight", 5-1). vector(k) makes the k-th when
/// it is added, so that few are alive at a time.
template <class V, class Vectors>
struct Adders {
  const Vectors& vector;
  std::array<V, 4> sums;  // of weight 1, 2, 4, 8

  /// Adds 2^kLevel vectors; what is carried has this weight.
  template <int kLevel, std::size_t kFirst>
  HWY_INLINE V carry() {
    if constexpr (kLevel == 0) {
      return vector(kFirst);
    } else {
      const V a = carry<kLevel - 1, kFirst>();
      const V b = carry<kLevel - 1, kFirst + (std::size_t{1} << (kLevel - 1))>();
      V& sum = sums[kLevel - 1];
      const V half = sum ^ a;
      const V carried = (sum & a) | (half & b);
      sum = half ^ b;
      return carried;
    }
  }
};

/// Bits that are set in kCount bytes per lane.
template <std::size_t kCount, std::size_t kFirst, class V, class Vectors>
HWY_INLINE V count_bits(const Vectors& vector) {
  constexpr int kWeights = kCountsBits || kCount < 3 ? 1 : kCount < 7 ? 2 : kCount < 15 ? 3 : 4;
  constexpr std::size_t kAdded = (std::size_t{1} << kWeights) - 1;
  Adders<V, Vectors> adders{vector, {}};
  auto& sums = adders.sums;
  sums[0] = adders.template carry<0, kFirst>();
  if constexpr (kWeights > 1) sums[1] = adders.template carry<1, kFirst + 1>();
  if constexpr (kWeights > 2) sums[2] = adders.template carry<2, kFirst + 3>();
  if constexpr (kWeights > 3) sums[3] = adders.template carry<3, kFirst + 7>();
  V count = population(sums[kWeights - 1]);
  for (std::size_t k = kWeights - 1; k-- > 0;) count = count + count + population(sums[k]);
  if constexpr (kCount > kAdded) {
    count = count + count_bits<kCount - kAdded, kFirst + kAdded, V>(vector);
  }
  return count;
}

/// columns += entering - leaving, each of which is at most 120.
template <class D>
HWY_INLINE void change(D /*d*/, hn::Vec<D> entering, hn::Vec<D> leaving, std::int16_t* columns) {
  const hn::RebindToSigned<D> d8s;
  const auto difference = hn::BitCast(d8s, hn::Sub(entering, leaving));
  if constexpr (2 * hn::MaxLanes(D()) <= HWY_MAX_BYTES) {
    const hn::Rebind<std::int16_t, D> d16;
    hn::StoreU(hn::Add(hn::LoadU(d16, columns), hn::PromoteTo(d16, difference)), d16, columns);
  } else {
    const hn::Half<decltype(d8s)> half;
    const hn::Rebind<std::int16_t, decltype(half)> d16;
    const auto lower = hn::PromoteTo(d16, hn::LowerHalf(half, difference));
    const auto upper = hn::PromoteTo(d16, hn::UpperHalf(half, difference));
    std::int16_t* second = columns + hn::Lanes(d16);
    hn::StoreU(hn::Add(hn::LoadU(d16, columns), lower), d16, columns);
    hn::StoreU(hn::Add(hn::LoadU(d16, second), upper), d16, second);
  }
}

/// kParts vectors of a column at a time. Some lanes are no disparities (kEdge), or all are.
template <class D, std::size_t kParts, std::size_t kPlanes, bool kEdge, int kPadded = 0>
HWY_INLINE void hamming_columns(const HammingRow row, int x0, int x1, std::uint8_t* slot,
                                std::int16_t* columns) {
  using V = Wide<D, kParts>;
  const D d;
  const int padded = kPadded > 0 ? kPadded : row.padded;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto number = hn::Iota(d, std::uint8_t{0});
  const auto first_of = [&](int count) HWY_ATTR {
    return hn::Lt(number, hn::Set(d, static_cast<std::uint8_t>(std::min(count, lanes))));
  };
  slot += static_cast<std::ptrdiff_t>(x0) * padded;
  columns += static_cast<std::ptrdiff_t>(x0) * padded;
  for (int x = x0; x < x1; ++x, slot += padded, columns += padded) {
    for (int first = 0; first < padded; first += static_cast<int>(kParts) * lanes) {
      const auto differing = [&](std::size_t k) HWY_ATTR {
        const std::ptrdiff_t plane = static_cast<std::ptrdiff_t>(k) * row.plane_pitch + x;
        const auto left = hn::Set(d, row.left[plane]);
        const std::uint8_t* right = row.right + plane - (padded - 1) + first;
        V bits;
        for (auto& part : bits.parts) {
          part = hn::Xor(left, hn::LoadU(d, right));
          right += lanes;
        }
        return bits;
      };
      V distances = count_bits<kPlanes, 0, V>(differing);
      int i = first;
      for (auto& distance : distances.parts) {
        if constexpr (kEdge) {
          const int unseen = padded - 1 - x - i, outside = padded - row.range - i;
          const auto half = hn::Set(d, static_cast<std::uint8_t>(row.half));
          if (unseen > 0) distance = hn::IfThenElse(first_of(unseen), half, distance);
          if (outside > 0) distance = hn::IfThenZeroElse(first_of(outside), distance);
        }
        change(d, distance, hn::LoadU(d, slot + i), columns + i);
        hn::StoreU(distance, d, slot + i);
        i += lanes;
      }
    }
  }
}

/// More vectors at a time than two, and their sums would not fit into the registers.
constexpr std::size_t kWide = hn::MaxLanes(TwoGroups()) < std::size_t{2} * kLaneGroup ? 2 : 1;

template <std::size_t kPlanes>
HWY_INLINE void hamming_anywhere(const HammingRow& row, int x0, int x1, std::uint8_t* slot,
                                 std::int16_t* columns) {
  hamming_columns<Group, 1, kPlanes, true>(row, x0, x1, slot, columns);
}

template <std::size_t kPlanes>
HWY_INLINE void hamming_planes(const HammingRow& row, int x0, int x1, std::uint8_t* slot,
                               std::int16_t* columns) {
  // From here on every disparity has a right pixel.
  const int inside = row.range == row.padded ? std::clamp(row.range - 1, x0, x1) : x1;
  hamming_anywhere<kPlanes>(row, x0, inside, slot, columns);
  if (row.padded == 2 * kLaneGroup) {
    hamming_columns<TwoGroups, kWide, kPlanes, false, 2 * kLaneGroup>(row, inside, x1, slot,
                                                                      columns);
  } else if (row.padded % (2 * kLaneGroup) == 0) {
    hamming_columns<TwoGroups, kWide, kPlanes, false>(row, inside, x1, slot, columns);
  } else {
    hamming_columns<Group, 1, kPlanes, false>(row, inside, x1, slot, columns);
  }
}

void hamming(const HammingRow& row, int x0, int x1, std::uint8_t* slot, std::int16_t* columns) {
  // The number of planes that a census of this window and pattern has. Of the usual ones each case
  // has code of its own; all of them would take minutes to compile with sanitizers.
  switch (row.planes) {
    case 1:
      return hamming_anywhere<1>(row, x0, x1, slot, columns);
    case 3:
      return hamming_planes<3>(row, x0, x1, slot, columns);
    case 6:
      return hamming_anywhere<6>(row, x0, x1, slot, columns);
    case 10:
      return hamming_anywhere<10>(row, x0, x1, slot, columns);
    default:
      return hamming_planes<15>(row, x0, x1, slot, columns);
  }
}

void leave(int padded, int x0, int x1, std::uint8_t* slot, std::int16_t* columns) {
  const Group d;
  const std::ptrdiff_t end = static_cast<std::ptrdiff_t>(x1) * padded;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(x0) * padded; i < end; i += lanes) {
    change(d, hn::Zero(d), hn::LoadU(d, slot + i), columns + i);
    hn::StoreU(hn::Zero(d), d, slot + i);
  }
}

void box(const std::int16_t* columns, int radius, int x0, int x1, const SumRing& ring) {
  const SumRing sums = ring;  // no store can change this one
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
