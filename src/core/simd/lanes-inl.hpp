// Operations on vectors that several stages need. A source that is compiled once per target
// includes this file after highway.h.

#if defined(FPGA_STEREO_SIMD_LANES_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef FPGA_STEREO_SIMD_LANES_INL_HPP
#undef FPGA_STEREO_SIMD_LANES_INL_HPP
#else
#define FPGA_STEREO_SIMD_LANES_INL_HPP
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#include "core/simd/layout.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, kLaneGroup>;
using VBytes = hn::Vec<Bytes>;
using Block8 = hn::CappedTag<std::uint8_t, 16>;  // 128 bits
using VBlock8 = hn::Vec<Block8>;

/// Returns |a - b| of unsigned lanes.
template <class V>
HWY_INLINE V absolute_difference(V a, V b) {
  return hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
}

/// Returns floor(dividend / divisor), at most kDisparityScale, for lanes of 32 bits. The dividend
/// must not be negative, and the divisor must be positive. The quotient is bounded first, so its
/// float approximation is off by 1 at most, which the remainder corrects.
template <class D>
HWY_INLINE hn::Vec<D> offset_quotient(D d, hn::Vec<D> dividend, hn::Vec<D> divisor) {
  const hn::RebindToFloat<D> df;
  const auto one = hn::Set(d, 1);
  const auto ratio = hn::Div(hn::ConvertTo(df, dividend), hn::ConvertTo(df, divisor));
  const auto bounded = hn::Min(ratio, hn::Set(df, static_cast<float>(kDisparityScale + 1)));
  auto quotient = hn::ConvertTo(d, bounded);
  const auto rest = hn::Sub(dividend, hn::Mul(quotient, divisor));
  quotient = hn::IfThenElse(hn::Lt(rest, hn::Zero(d)), hn::Sub(quotient, one), quotient);
  quotient = hn::IfThenElse(hn::Gt(rest, hn::Sub(divisor, one)), hn::Add(quotient, one), quotient);
  return hn::Min(quotient, hn::Set(d, kDisparityScale));
}

/// Returns `v` moved up by one lane. The last lane of `below` enters at lane 0.
HWY_INLINE VBytes from_below(VBytes v, VBytes below) {
  const Bytes d;
  if constexpr (hn::MaxLanes(Bytes()) <= 16) {
    return hn::CombineShiftRightBytes<15>(d, v, below);
  } else {
    return hn::CombineShiftRightBytes<15>(d, v, hn::ConcatLowerUpper(d, v, below));
  }
}

/// Returns `v` moved down by one lane. Lane 0 of `above` enters at the last lane.
HWY_INLINE VBytes from_above(VBytes v, VBytes above) {
  const Bytes d;
  if constexpr (hn::MaxLanes(Bytes()) <= 16) {
    return hn::CombineShiftRightBytes<1>(d, above, v);
  } else {
    return hn::CombineShiftRightBytes<1>(d, hn::ConcatLowerUpper(d, above, v), v);
  }
}

struct Smallest {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};

/// Returns for each position in a block of 128 bits the extreme (Smallest, for example) of all
/// blocks of `v`.
template <class Extreme, class D>
HWY_INLINE auto fold(D /*d*/, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) * sizeof(hn::TFromD<D>) <= 16) {
    return v;
  } else {
    const hn::Half<D> half;
    return fold<Extreme>(half, Extreme()(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

/// Returns for each position in a block the smallest of all blocks of `v`.
HWY_INLINE VBlock8 smallest_block(VBytes v) { return fold<Smallest>(Bytes(), v); }

/// Returns the smallest of pairs of lanes of `a` and of `b`, interleaved.
HWY_INLINE VBlock8 smallest_pairs(VBlock8 a, VBlock8 b) {
  const Block8 d;
  return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
}

/// Returns a block whose lane k is the smallest byte of block number k of 16 `blocks`.
template <int kStride = 1>
HWY_INLINE VBlock8 smallest_of_blocks(const std::uint8_t* blocks, int first = 0) {
  if constexpr (kStride == 16) {
    return hn::LoadU(Block8(), blocks + 16 * first);
  } else {
    return smallest_pairs(smallest_of_blocks<2 * kStride>(blocks, first),
                          smallest_of_blocks<2 * kStride>(blocks, first + kStride));
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
