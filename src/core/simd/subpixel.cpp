#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/subpixel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/lanes-inl.hpp"
#include "core/simd/stages.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

using D32 = hn::CappedTag<std::int32_t, 16>;
using V32 = hn::Vec<D32>;
using From8 = hn::Rebind<std::uint8_t, D32>;
using From16 = hn::Rebind<std::uint16_t, D32>;

namespace {  // another file has another load()

HWY_INLINE V32 load(const std::uint8_t* from) {
  return hn::PromoteTo(D32(), hn::LoadU(From8(), from));
}
HWY_INLINE V32 load(const std::uint16_t* from) {
  return hn::PromoteTo(D32(), hn::LoadU(From16(), from));
}

/// Computes vertex() of the scalar twin.
HWY_INLINE V32 vertex(const SelectionRow& s, int x) {
  const D32 d;
  const auto c0 = load(s.around[0] + x), c1 = load(s.around[1] + x), c2 = load(s.around[2] + x);
  const auto c3 = load(s.around[3] + x), c4 = load(s.around[4] + x);
  const auto twice = [](V32 v) { return hn::Add(v, v); };
  const auto num = hn::Sub(hn::Add(twice(hn::Sub(c0, c4)), c1), c3);
  const auto den = hn::Sub(twice(hn::Sub(hn::Add(c0, c4), c2)), hn::Add(c1, c3));
  const auto a = hn::Mul(hn::Abs(num), hn::Set(d, kDisparityScale * kSubpixelNumerator));
  const auto b = hn::Mul(den, hn::Set(d, kSubpixelDenominator));
  const auto dividend = hn::Add(twice(a), b), divisor = twice(b);
  const auto valid = hn::Gt(den, hn::Zero(d));
  const auto safe = hn::IfThenElse(valid, divisor, hn::Set(d, 1));
  const auto quotient = offset_quotient(d, dividend, safe);
  const auto offset = hn::IfThenElse(hn::Lt(num, hn::Zero(d)), hn::Neg(quotient), quotient);
  return hn::IfThenElseZero(valid, offset);
}

}  // namespace

void subpixel(const SelectionRow& s, const std::uint8_t* kept, const Parameters& p,
              std::uint16_t* disparity) {
  const D32 d;
  const int width = s.width, range = p.disparity_range;
  const bool refine = p.subpixel;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  const auto first = hn::Set(d, 1), end = hn::Set(d, range - 2);
  const auto max = hn::Set(d, (range - 1) * kDisparityScale);
  const auto invalid = hn::Set(d, static_cast<std::int32_t>(kNoDisparity));
  for (int x = 0; x < width; x += lanes) {
    const auto winner = load(s.winner + x);
    auto value = hn::Mul(winner, hn::Set(d, kDisparityScale));
    if (refine) {
      const auto is_inner = hn::And(hn::Gt(winner, first), hn::Lt(winner, end));
      value = hn::Add(value, hn::IfThenElseZero(is_inner, vertex(s, x)));
    }
    value = hn::Min(hn::Max(value, zero), max);
    value = hn::IfThenElse(hn::Eq(load(kept + x), zero), invalid, value);
    hn::StoreU(hn::DemoteTo(From16(), value), From16(), disparity + x);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(subpixel);

void subpixel(const SelectionRow& s, const std::uint8_t* kept, const Parameters& p,
              std::uint16_t* disparity) {
  HWY_DYNAMIC_DISPATCH(subpixel)(s, kept, p, disparity);
}

}  // namespace fpga_stereo::simd
#endif
