#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/match_hamming.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/match.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Group = hn::CappedTag<std::uint8_t, kLaneGroup>;
using TwoGroups = hn::CappedTag<std::uint8_t, std::size_t{2} * kLaneGroup>;

#if HWY_TARGET == HWY_AVX3_DL
constexpr bool kHasPopulationCount = true;  // PopulationCount is one instruction
#else
constexpr bool kHasPopulationCount = false;
#endif

/// kParts vectors that share what is loaded for all of them.
template <class D, std::size_t kParts>
struct Wide {
  hn::Vec<D> parts[kParts];

  // GCC compiles an implicit constructor without the instructions of the target.
  HWY_INLINE Wide() {}  // NOLINT(modernize-use-equals-default)
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

/// Carry-save adders of bit vectors (H. S. Warren, "Hacker's Delight", 5-1). vector(k) computes the
/// k-th vector when it is added, so that few occupy registers at a time.
template <class V, class Vectors>
struct Adders {
  const Vectors& vector;
  V sums[4];  // bits of weight 1, 2, 4, 8

  /// Adds the 2^kLevel vectors from kFirst on. Returns the carry, which has weight 2^kLevel.
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

/// Returns the number of bits set in kCount bytes per lane.
template <std::size_t kCount, std::size_t kFirst, class V, class Vectors>
HWY_INLINE V count_bits(const Vectors& vector) {
  constexpr int kWeights = kHasPopulationCount || kCount < 3 ? 1
                           : kCount < 7                      ? 2
                           : kCount < 15                     ? 3
                                                             : 4;
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

/// columns += entering - leaving. Distances are at most 120, so the difference fits into 8 bits.
template <class D>
HWY_INLINE void update_columns(D /*d*/, hn::Vec<D> entering, hn::Vec<D> leaving,
                               std::int16_t* columns) {
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

/// Processes kParts vectors of a column at a time. With kEdge, some lanes may have no disparity or
/// no right pixel. kLanes > 0 fixes the lanes per pixel at compile time.
template <class D, std::size_t kParts, std::size_t kPlanes, bool kEdge, int kLanes = 0>
HWY_INLINE void hamming_columns(const HammingRow row, int begin, int end, std::uint8_t* distances,
                                std::int16_t* columns) {
  using V = Wide<D, kParts>;
  const D d;
  const int pixel_lanes = kLanes > 0 ? kLanes : row.lanes;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto number = hn::Iota(d, std::uint8_t{0});
  const auto first_of = [&](int count) HWY_ATTR {
    return hn::Lt(number, hn::Set(d, static_cast<std::uint8_t>(std::min(count, lanes))));
  };
  distances += static_cast<std::ptrdiff_t>(begin) * pixel_lanes;
  columns += static_cast<std::ptrdiff_t>(begin) * pixel_lanes;
  for (int x = begin; x < end; ++x, distances += pixel_lanes, columns += pixel_lanes) {
    for (int first = 0; first < pixel_lanes; first += static_cast<int>(kParts) * lanes) {
      const auto differing = [&](std::size_t k) HWY_ATTR {
        const std::ptrdiff_t plane = static_cast<std::ptrdiff_t>(k) * row.plane_pitch + x;
        const auto left = hn::Set(d, row.left[plane]);
        const std::uint8_t* right = row.right + plane - (pixel_lanes - 1) + first;
        V bits;
        for (auto& part : bits.parts) {
          part = hn::Xor(left, hn::LoadU(d, right));
          right += lanes;
        }
        return bits;
      };
      V counts = count_bits<kPlanes, 0, V>(differing);
      int i = first;
      for (auto& distance : counts.parts) {
        if constexpr (kEdge) {
          // Lanes whose right pixel is left of the image, and lanes without a disparity.
          const int unseen = pixel_lanes - 1 - x - i, unused = pixel_lanes - row.range - i;
          const auto half = hn::Set(d, static_cast<std::uint8_t>(row.half));
          if (unseen > 0) distance = hn::IfThenElse(first_of(unseen), half, distance);
          if (unused > 0) distance = hn::IfThenZeroElse(first_of(unused), distance);
        }
        update_columns(d, distance, hn::LoadU(d, distances + i), columns + i);
        hn::StoreU(distance, d, distances + i);
        i += lanes;
      }
    }
  }
}

/// Vectors of TwoGroups at a time: the sums of more than two do not fit into the registers.
constexpr std::size_t kWide = hn::MaxLanes(TwoGroups()) < std::size_t{2} * kLaneGroup ? 2 : 1;

template <std::size_t kPlanes>
HWY_INLINE void hamming_with_edges(const HammingRow& row, int begin, int end,
                                   std::uint8_t* distances, std::int16_t* columns) {
  hamming_columns<Group, 1, kPlanes, true>(row, begin, end, distances, columns);
}

template <std::size_t kPlanes>
HWY_INLINE void hamming_planes(const HammingRow& row, int begin, int end, std::uint8_t* distances,
                               std::int16_t* columns) {
  // From column `inside` on, every disparity has a right pixel.
  const int inside = row.range == row.lanes ? std::clamp(row.range - 1, begin, end) : end;
  hamming_with_edges<kPlanes>(row, begin, inside, distances, columns);
  if (row.lanes == 2 * kLaneGroup) {
    hamming_columns<TwoGroups, kWide, kPlanes, false, 2 * kLaneGroup>(row, inside, end, distances,
                                                                      columns);
  } else if (row.lanes % (2 * kLaneGroup) == 0) {
    hamming_columns<TwoGroups, kWide, kPlanes, false>(row, inside, end, distances, columns);
  } else {
    hamming_columns<Group, 1, kPlanes, false>(row, inside, end, distances, columns);
  }
}

void hamming_distances(const HammingRow& row, int begin, int end, std::uint8_t* distances,
                       std::int16_t* columns) {
  // These are the numbers of planes that census windows and patterns lead to. Only the usual ones,
  // 3 and 15, get code without edges: with more, sanitizers take minutes to compile this file.
  switch (row.planes) {
    case 1:
      return hamming_with_edges<1>(row, begin, end, distances, columns);
    case 3:
      return hamming_planes<3>(row, begin, end, distances, columns);
    case 6:
      return hamming_with_edges<6>(row, begin, end, distances, columns);
    case 10:
      return hamming_with_edges<10>(row, begin, end, distances, columns);
    default:
      return hamming_planes<15>(row, begin, end, distances, columns);
  }
}

void clear_distances(int lanes, int begin, int end, std::uint8_t* distances,
                     std::int16_t* columns) {
  const Group d;
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(end) * lanes;
  const auto step = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(begin) * lanes; i < last; i += step) {
    update_columns(d, hn::Zero(d), hn::LoadU(d, distances + i), columns + i);
    hn::StoreU(hn::Zero(d), d, distances + i);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(hamming_distances);
HWY_EXPORT(clear_distances);

void hamming_distances(const HammingRow& row, int begin, int end, std::uint8_t* distances,
                       std::int16_t* columns) {
  HWY_DYNAMIC_DISPATCH(hamming_distances)(row, begin, end, distances, columns);
}
void clear_distances(int lanes, int begin, int end, std::uint8_t* distances,
                     std::int16_t* columns) {
  HWY_DYNAMIC_DISPATCH(clear_distances)(lanes, begin, end, distances, columns);
}

}  // namespace fpga_stereo::simd
#endif
