#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/check.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/stages.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void check(const SelectionRow& s, const Parameters& p, std::uint8_t* kept) {
  const hn::CappedTag<std::uint16_t, 32> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const hn::RebindToSigned<decltype(d)> d_signed;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int width = s.width, factor = uniqueness_factor(p), max_difference = p.disp12MaxDiff;
  const bool left_right = p.left_right_check, uniqueness = p.uniqueness_check && !p.dense;
  const auto set = [&](int value)
                       HWY_ATTR { return hn::Set(d, static_cast<std::uint16_t>(value)); };
  const auto load8 = [&](const std::uint8_t* from)
                         HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(bytes, from)); };
  if (left_right) {
    // The right winners of the left winners' partners, by scalar loads: gathers are no faster.
    const std::uint8_t *winner = s.winner, *right = s.right_winner;
    constexpr int kUnrolled = 8;
    for (int first = 0; first < width; first += kUnrolled) {
      for (int x = first; x < first + kUnrolled; ++x) kept[x] = right[x - winner[x]];
    }
  }
  for (int x = 0; x < width; x += lanes) {
    auto keep = set(1);
    if (left_right) {
      const auto winner = load8(s.winner + x), partner = load8(kept + x);
      const auto outside = hn::Lt(hn::Iota(d, static_cast<std::uint16_t>(x)), winner);
      const auto difference = hn::Sub(hn::Max(winner, partner), hn::Min(winner, partner));
      const auto differs = hn::Lt(set(max_difference), difference);
      keep = hn::IfThenZeroElse(hn::Or(outside, differs), keep);
    }
    if (uniqueness) {
      // kUniquenessScale runner_up > factor winner. As the left side is a multiple of the scale,
      // the product may be divided by the scale first.
      static_assert(kUniquenessScale == 256);
      const auto winner = hn::LoadU(d, s.winner_sum + x);
      const auto runner_up = hn::LoadU(d, s.runner_up_sum + x);
      const auto upper = hn::MulHigh(winner, set(factor)), lower = hn::Mul(winner, set(factor));
      const auto bound = hn::Or(hn::ShiftLeft<8>(upper), hn::ShiftRight<8>(lower));
      const auto too_large = hn::Lt(set(0xFF), upper);
      keep = hn::IfThenElseZero(hn::Lt(bound, runner_up), hn::IfThenZeroElse(too_large, keep));
    }
    hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(d_signed, keep)), bytes, kept + x);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(check);

void check(const SelectionRow& s, const Parameters& p, std::uint8_t* kept) {
  HWY_DYNAMIC_DISPATCH(check)(s, p, kept);
}

}  // namespace fpga_stereo::simd
#endif
