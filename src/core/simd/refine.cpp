// check, subpixel, and which pixels speckle connects.
#include <algorithm>
#include <array>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/refine.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/kernels.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMost = 16;  // pixels at a time

using D32 = hn::CappedTag<std::int32_t, kMost>;
using V32 = hn::Vec<D32>;
using From8 = hn::Rebind<std::uint8_t, D32>;
using From16 = hn::Rebind<std::uint16_t, D32>;

HWY_INLINE V32 load(const std::uint8_t* from) {
  return hn::PromoteTo(D32(), hn::LoadU(From8(), from));
}
HWY_INLINE V32 load(const std::uint16_t* from) {
  return hn::PromoteTo(D32(), hn::LoadU(From16(), from));
}

void check_row(const SelectedRow& s, int width, bool left_right, int most_difference,
               bool uniqueness, int factor, std::uint8_t* kept) {
  const hn::CappedTag<std::uint16_t, 2 * kMost> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const hn::RebindToSigned<decltype(d)> d_signed;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto set = [&](int value)
                       HWY_ATTR { return hn::Set(d, static_cast<std::uint16_t>(value)); };
  const auto load8 = [&](const std::uint8_t* from)
                         HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(bytes, from)); };
  if (left_right) {
    // What the partners say, by plain loads: gathers are no faster.
    const std::uint8_t *winner = s.winner, *right = s.right_winner;
    constexpr int kTurn = 8;
    for (int first = 0; first < width; first += kTurn) {
      for (int x = first; x < first + kTurn; ++x) kept[x] = right[x - winner[x]];
    }
  }
  for (int x = 0; x < width; x += lanes) {
    auto keep = set(1);
    if (left_right) {
      const auto winner = load8(s.winner + x), partner = load8(kept + x);
      const auto outside = hn::Lt(hn::Iota(d, static_cast<std::uint16_t>(x)), winner);
      const auto difference = hn::Sub(hn::Max(winner, partner), hn::Min(winner, partner));
      const auto differs = hn::Lt(set(most_difference), difference);
      keep = hn::IfThenZeroElse(hn::Or(outside, differs), keep);
    }
    if (uniqueness) {
      // kUniquenessScale rival > factor winner, where the product divided by the scale is enough.
      static_assert(kUniquenessScale == 256);
      const auto winner = hn::LoadU(d, s.winner_sum + x), rival = hn::LoadU(d, s.runner_up_sum + x);
      const auto upper = hn::MulHigh(winner, set(factor)), lower = hn::Mul(winner, set(factor));
      const auto least = hn::Or(hn::ShiftLeft<8>(upper), hn::ShiftRight<8>(lower));
      const auto too_large = hn::Lt(set(0xFF), upper);
      keep = hn::IfThenElseZero(hn::Lt(least, rival), hn::IfThenZeroElse(too_large, keep));
    }
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(d_signed, keep)), bytes, kept + x);
  }
}

/// As vertex() of the scalar twin. The quotient is at most kDisparityScale before it is clamped, so
/// that one of floats is at most 1 off.
HWY_INLINE V32 vertex(const SelectedRow& s, int x) {
  const D32 d;
  const hn::RebindToFloat<D32> df;
  const auto c0 = load(s.around[0] + x), c1 = load(s.around[1] + x), c2 = load(s.around[2] + x);
  const auto c3 = load(s.around[3] + x), c4 = load(s.around[4] + x);
  const auto twice = [](V32 v) { return hn::Add(v, v); };
  const auto num = hn::Sub(hn::Add(twice(hn::Sub(c0, c4)), c1), c3);
  const auto den = hn::Sub(twice(hn::Sub(hn::Add(c0, c4), c2)), hn::Add(c1, c3));
  const auto a = hn::Mul(hn::Abs(num), hn::Set(d, kDisparityScale * kSubpixelNumerator));
  const auto b = hn::Mul(den, hn::Set(d, kSubpixelDenominator));
  const auto dividend = hn::Add(twice(a), b), divisor = twice(b);
  const auto valid = hn::Gt(den, hn::Zero(d));
  const auto one = hn::Set(d, 1);
  const auto safe = hn::IfThenElse(valid, divisor, one);
  const auto most = hn::Set(d, kDisparityScale);
  const auto ratio = hn::Div(hn::ConvertTo(df, dividend), hn::ConvertTo(df, safe));
  const auto bounded = hn::Min(ratio, hn::Set(df, static_cast<float>(kDisparityScale + 1)));
  auto quotient = hn::ConvertTo(d, bounded);
  const auto rest = hn::Sub(dividend, hn::Mul(quotient, safe));
  quotient = hn::IfThenElse(hn::Lt(rest, hn::Zero(d)), hn::Sub(quotient, one), quotient);
  quotient = hn::IfThenElse(hn::Gt(rest, hn::Sub(safe, one)), hn::Add(quotient, one), quotient);
  quotient = hn::Min(quotient, most);
  const auto offset = hn::IfThenElse(hn::Lt(num, hn::Zero(d)), hn::Neg(quotient), quotient);
  return hn::IfThenElseZero(valid, offset);
}

void subpixel_row(const SelectedRow& s, const std::uint8_t* kept, int width, int range, bool refine,
                  std::uint16_t* disparity) {
  const D32 d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto zero = hn::Zero(d);
  const auto first = hn::Set(d, 1), end = hn::Set(d, range - 2);
  const auto most = hn::Set(d, (range - 1) * kDisparityScale);
  const auto none = hn::Set(d, static_cast<std::int32_t>(kNoDisparity));
  for (int x = 0; x < width; x += lanes) {
    const auto winner = load(s.winner + x);
    auto value = hn::Mul(winner, hn::Set(d, kDisparityScale));
    if (refine) {
      const auto inner = hn::And(hn::Gt(winner, first), hn::Lt(winner, end));
      value = hn::Add(value, hn::IfThenElseZero(inner, vertex(s, x)));
    }
    value = hn::Min(hn::Max(value, zero), most);
    value = hn::IfThenElse(hn::Eq(load(kept + x), zero), none, value);
    hn::StoreU(hn::DemoteTo(From16(), value), From16(), disparity + x);
  }
}

void connect_row(const std::uint16_t* row, const std::uint16_t* above, int width, int range,
                 const ConnectedRow& out) {
  const hn::CappedTag<std::uint16_t, 32> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto none = hn::Set(d, kNoDisparity);
  const auto end = hn::Set(d, static_cast<std::uint16_t>(range + 1));
  const auto bits = [&](auto mask) {
    std::array<std::uint8_t, 8> made{};
    hn::StoreMaskBits(d, mask, made.data());
    std::uint64_t word = 0;
    std::memcpy(&word, made.data(), sizeof word);
    return word;
  };
  const auto difference = [](auto a, auto b) { return hn::Sub(hn::Max(a, b), hn::Min(a, b)); };
  for (int x = 0; x < width; x += 64) {
    std::uint64_t valid = 0, left = 0, up = 0;
    for (int i = 0; i < 64; i += lanes) {
      const auto here = hn::LoadU(d, row + x + i);
      // "None" is further from every disparity than any range.
      valid |= bits(hn::Ne(here, none)) << i;
      left |= bits(hn::Lt(difference(here, hn::LoadU(d, row + x + i - 1)), end)) << i;
      up |= bits(hn::Lt(difference(here, hn::LoadU(d, above + x + i)), end)) << i;
    }
    if (width - x < 64) valid &= (std::uint64_t{1} << (width - x)) - 1;
    out.valid[x / 64] = valid;
    out.left[x / 64] = left & valid;
    out.up[x / 64] = up & valid;
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(check_row);
HWY_EXPORT(subpixel_row);
HWY_EXPORT(connect_row);

void check_row(const SelectedRow& s, int width, bool left_right, int most_difference,
               bool uniqueness, int factor, std::uint8_t* kept) {
  HWY_DYNAMIC_DISPATCH(check_row)(s, width, left_right, most_difference, uniqueness, factor, kept);
}
void subpixel_row(const SelectedRow& s, const std::uint8_t* kept, int width, int range, bool refine,
                  std::uint16_t* disparity) {
  HWY_DYNAMIC_DISPATCH(subpixel_row)(s, kept, width, range, refine, disparity);
}
void connect_row(const std::uint16_t* row, const std::uint16_t* above, int width, int range,
                 const ConnectedRow& out) {
  HWY_DYNAMIC_DISPATCH(connect_row)(row, above, width, range, out);
}

}  // namespace fpga_stereo::simd
#endif
