#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/select.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/lanes-inl.hpp"
#include "core/simd/select.hpp"
#include "core/simd/stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

using D16 = hn::CappedTag<std::uint16_t, kLaneGroup>;
using V16 = hn::Vec<D16>;
using Block = hn::CappedTag<std::uint16_t, 8>;  // 128 bits
using VBlock = hn::Vec<Block>;

constexpr std::size_t kPixels = 8;  // processed at a time
constexpr std::uint16_t kMaxSum = 0xFFFF;

struct Largest {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};

// In what follows, Extreme is Smallest or Largest.

/// Returns, for each block, the extremes of pairs of lanes of `a` and of `b`, interleaved.
template <class Extreme>
HWY_INLINE V16 pair(V16 a, V16 b) {
  const D16 d;
  return Extreme()(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
}

/// Returns a block whose lane k is the extreme of all lanes of pixels[k].
template <class Extreme>
HWY_INLINE VBlock extreme(const V16 (&pixels)[kPixels]) {
  const auto& p = pixels;
  const V16 even = pair<Extreme>(pair<Extreme>(p[0], p[4]), pair<Extreme>(p[2], p[6]));
  const V16 odd = pair<Extreme>(pair<Extreme>(p[1], p[5]), pair<Extreme>(p[3], p[7]));
  return fold<Extreme>(D16(), pair<Extreme>(even, odd));
}

/// Transposes and stores the sums of each winner's neighbours. pixels[k] has those of pixel x + k,
/// from disparity dL + 2 down.
HWY_INLINE void store_around(const VBlock (&pixels)[kPixels], const SelectionRow& out, int x) {
  const Block d;
  // Interleaving pixels that are 4, 2 and 1 apart brings the sums of each neighbour together.
  const auto low = [&](VBlock a, VBlock b) { return hn::InterleaveLower(d, a, b); };
  const auto high = [&](VBlock a, VBlock b) { return hn::InterleaveUpper(d, a, b); };
  const auto& p = pixels;
  const VBlock a04 = low(p[0], p[4]), a15 = low(p[1], p[5]), a26 = low(p[2], p[6]),
               a37 = low(p[3], p[7]);
  const VBlock even = low(a04, a26), odd = low(a15, a37);              // neighbours 0 and 1
  const VBlock even_next = high(a04, a26), odd_next = high(a15, a37);  // 2 and 3
  const VBlock even_last = low(high(p[0], p[4]), high(p[2], p[6]));
  const VBlock odd_last = low(high(p[1], p[5]), high(p[3], p[7]));
  hn::StoreU(low(even, odd), d, out.around[4] + x);
  hn::StoreU(high(even, odd), d, out.around[3] + x);
  hn::StoreU(low(even_next, odd_next), d, out.around[2] + x);
  hn::StoreU(high(even_next, odd_next), d, out.around[1] + x);
  hn::StoreU(low(even_last, odd_last), d, out.around[0] + x);
}

/// Lane numbers + 1, so that 0 means no lane.
constexpr auto kLaneNumbers = [] {
  std::array<std::uint16_t, 256> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i + 1);
  return values;
}();
/// kMaxSum at lanes 255 .. 257, to exclude a winner and its neighbours from the runners-up.
constexpr auto kWinnerMask = [] {
  std::array<std::uint16_t, 2 * 256 + kLaneGroup> values{};
  for (const std::size_t i : {255U, 256U, 257U}) values[i] = kMaxSum;
  return values;
}();

/// Selects for left pixels, kPixels at a time, in three steps. kGroups lane groups per pixel; 0:
/// the number is known at run time.
template <int kGroups>
struct SelectLeft {
  const WindowSums sums;
  const SelectionRow out;
  // Lane of each winner + 1, for pixel x at x % (2 * kPixels).
  alignas(16) std::array<std::uint16_t, 2 * kPixels> ends{};

  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D16()));
  HWY_INLINE int lanes() const { return kGroups > 0 ? kGroups * kLaneGroup : sums.lanes; }

  HWY_INLINE void winner_sums(int x) const {
    const D16 d;
    V16 pixels[kPixels];
    const std::uint16_t* s = sums.column(x);
    for (std::size_t k = 0; k < kPixels; ++k, s += sums.pitch) {
      pixels[k] = hn::LoadU(d, s);
      for (int i = kLanes; i < lanes(); i += kLanes) {
        pixels[k] = hn::Min(pixels[k], hn::LoadU(d, s + i));
      }
    }
    hn::StoreU(extreme<Smallest>(pixels), Block(), out.winner_sum + x);
  }

  /// Finds the lowest disparities with these sums: those in the last lanes.
  HWY_INLINE void winners(int x) {
    const D16 d;
    const Block block;
    const hn::Rebind<std::uint8_t, Block> bytes;
    V16 pixels[kPixels];
    const std::uint16_t* s = sums.column(x);
    for (std::size_t k = 0; k < kPixels; ++k, s += sums.pitch) {
      const auto sum = hn::Set(d, out.winner_sum[x + static_cast<int>(k)]);
      pixels[k] = hn::Zero(d);
      for (int i = 0; i < lanes(); i += kLanes) {
        const auto number = hn::LoadU(d, &kLaneNumbers[static_cast<std::size_t>(i)]);
        const auto wins = hn::Eq(hn::LoadU(d, s + i), sum);
        pixels[k] = hn::Max(pixels[k], hn::IfThenElseZero(wins, number));
      }
    }
    const auto end = extreme<Largest>(pixels);
    hn::Store(end, block, &ends[static_cast<std::size_t>(x) % ends.size()]);
    const auto winner = hn::Sub(hn::Set(block, static_cast<std::uint16_t>(lanes())), end);
    const auto signed_winner = hn::BitCast(hn::RebindToSigned<Block>(), winner);
    hn::StoreU(hn::DemoteTo(bytes, signed_winner), bytes, out.winner + x);
  }

  HWY_INLINE void runners_up(int x) const {
    const D16 d;
    V16 pixels[kPixels];
    VBlock around[kPixels];
    const std::uint16_t* end = &ends[static_cast<std::size_t>(x) % ends.size()];
    const std::uint16_t* s = sums.column(x);
    for (std::size_t k = 0; k < kPixels; ++k, s += sums.pitch) {
      const std::uint16_t* neighbours = &kWinnerMask[std::size_t{257} - end[k]];
      pixels[k] = hn::Or(hn::LoadU(d, s), hn::LoadU(d, neighbours));
      for (int i = kLanes; i < lanes(); i += kLanes) {
        const auto others = hn::Or(hn::LoadU(d, s + i), hn::LoadU(d, neighbours + i));
        pixels[k] = hn::Min(pixels[k], others);
      }
      around[k] = hn::LoadU(Block(), s + end[k] - 3);
    }
    hn::StoreU(extreme<Smallest>(pixels), Block(), out.runner_up_sum + x);
    store_around(around, out, x);
  }

  /// Software-pipelined: each step works on other pixels, to hide the latency of the horizontal
  /// minimum of the step before it.
  HWY_INLINE void run() {
    constexpr int kStep = static_cast<int>(kPixels);
    for (int x = sums.begin; x < sums.end + 2 * kStep; x += kStep) {
      if (x < sums.end) winner_sums(x);
      if (sums.begin < x && x < sums.end + kStep) winners(x - kStep);
      if (sums.begin + kStep < x) runners_up(x - 2 * kStep);
    }
  }
};

void select_left(const WindowSums& sums, const SelectionRow& out) {
  switch (sums.lanes / kLaneGroup) {
    case 1:
      return SelectLeft<1>{sums, out}.run();
    case 2:
      return SelectLeft<2>{sums, out}.run();
    case 4:
      return SelectLeft<4>{sums, out}.run();
    default:
      return SelectLeft<0>{sums, out}.run();
  }
}

constexpr std::size_t kParts = kLaneGroup / hn::MaxLanes(D16());

/// The smallest sums of kLaneGroup right pixels so far, and the left pixels that have them.
struct RightMinimum {
  V16 sum[kParts], partner[kParts];

  HWY_INLINE RightMinimum() {
    for (V16& s : sum) s = hn::Set(D16(), kMaxSum);
    for (V16& p : partner) p = hn::Zero(D16());
  }
  /// Considers the sums of left pixel `number`.
  HWY_INLINE void add(const std::uint16_t* sums, V16 number) {
    const D16 d;
    for (std::size_t k = 0; k < kParts; ++k) {
      const auto smaller = hn::Min(sum[k], hn::LoadU(d, sums + k * hn::Lanes(d)));
      partner[k] = hn::IfThenElse(hn::Eq(smaller, sum[k]), partner[k], number);
      sum[k] = smaller;
    }
  }
  /// Considers what `other` found. Of equal sums, the left pixel further left wins.
  HWY_INLINE void merge(const RightMinimum& other) {
    for (std::size_t k = 0; k < kParts; ++k) {
      const auto smaller = hn::Min(sum[k], other.sum[k]);
      const auto first = hn::Min(partner[k], other.partner[k]);
      const auto here = hn::Eq(smaller, sum[k]), there = hn::Eq(smaller, other.sum[k]);
      const auto one = hn::IfThenElse(here, partner[k], other.partner[k]);
      partner[k] = hn::IfThenElse(hn::And(here, there), first, one);
      sum[k] = smaller;
    }
  }
};

/// Considers left pixels x .. end - 1 as partners of the right pixels from `first` on. The ring
/// must not wrap between them. `even` and `odd` take turns: two chains that do not wait for each
/// other.
HWY_INLINE void add_partners(const WindowSums& sums, int first, int x, int end, RightMinimum& even,
                             RightMinimum& odd) {
  const D16 d;
  // Left pixel x is a partner of right pixels x - range + 1 .. x; for others its sum is kMaxSum.
  const std::uint16_t* sum = sums.column(x) + (first - x + sums.lanes - 1);
  const std::ptrdiff_t step = sums.pitch - 1;
  auto number = hn::Set(d, static_cast<std::uint16_t>(x));
  const auto one = hn::Set(d, std::uint16_t{1});
  for (; x < end - 1; x += 2, sum += 2 * step) {
    const auto next = hn::Add(number, one);
    even.add(sum, number);
    odd.add(sum + step, next);
    number = hn::Add(next, one);
  }
  if (x < end) even.add(sum, number);
}

void select_right(const WindowSums& sums, int x0, std::uint8_t* right_winner) {
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const hn::RebindToSigned<D16> d16s;
  const int end = std::min(x0 + kLaneGroup + sums.range - 1, sums.width);
  const int wrap = (x0 | sums.mask) + 1;  // the ring wraps here
  RightMinimum best, odd;
  add_partners(sums, x0, x0, std::min(end, wrap), best, odd);
  if (wrap < end) add_partners(sums, x0, wrap, end, best, odd);
  best.merge(odd);
  for (std::size_t k = 0; k < kParts; ++k) {
    const int first = x0 + static_cast<int>(k * hn::Lanes(d));
    const auto disparity = hn::Sub(best.partner[k], hn::Iota(d, static_cast<std::uint16_t>(first)));
    const auto bytes = hn::BitCast(d16s, hn::And(disparity, hn::Set(d, std::uint16_t{0xFF})));
    hn::StoreU(hn::DemoteTo(d8, bytes), d8, right_winner + first);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(select_left);
HWY_EXPORT(select_right);

void select_left(const WindowSums& sums, const SelectionRow& out) {
  HWY_DYNAMIC_DISPATCH(select_left)(sums, out);
}
void select_right(const WindowSums& sums, int x0, std::uint8_t* right_winner) {
  HWY_DYNAMIC_DISPATCH(select_right)(sums, x0, right_winner);
}

void select(const WindowSums& sums, const SelectionRow& out) {
  select_left(sums, out);
  // Returns the number of right pixels, in whole lane groups, whose left partners all lie to the
  // left of column x.
  const auto complete = [&](int x) {
    if (x == sums.width) return sums.width;
    return std::max(0, x - sums.range + 1) / kLaneGroup * kLaneGroup;
  };
  const int end = complete(sums.end);
  for (int x = complete(sums.begin); x < end; x += kLaneGroup) {
    select_right(sums, x, out.right_winner);
  }
}

}  // namespace fpga_stereo::simd
#endif
