// Operations across the lanes of vectors, for the stages of semi-global matching. A source that is
// compiled once per target includes this file after highway.h.

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

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Bytes = hn::CappedTag<std::uint8_t, kLaneGroup>;
using VBytes = hn::Vec<Bytes>;
using Block8 = hn::CappedTag<std::uint8_t, 16>;  // 128 bits
using VBlock8 = hn::Vec<Block8>;

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

/// Returns for each position in a block the smallest of all blocks of `v`.
template <class D = Bytes>
HWY_INLINE VBlock8 smallest_block(hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) <= 16) {
    return v;
  } else {
    const hn::Half<D> half;
    return hn::Min(hn::LowerHalf(half, v), hn::UpperHalf(half, v));
  }
}

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
