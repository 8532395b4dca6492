#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/select.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/kernels.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D16 = hn::CappedTag<std::uint16_t, kLaneGroup>;
using V16 = hn::Vec<D16>;
using Block = hn::CappedTag<std::uint16_t, 8>;  // 128 bits
using VBlock = hn::Vec<Block>;

constexpr std::size_t kPixels = 8;  // that are worked on at a time
constexpr std::uint16_t kMost = 0xFFFF;

struct Smaller {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Min(a, b);
  }
};
struct Larger {
  template <class V>
  HWY_INLINE V operator()(V a, V b) const {
    return hn::Max(a, b);
  }
};

/// The smallest, or the largest, lane of every position in a block.
template <class Of, class D>
HWY_INLINE VBlock fold(D /*d*/, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) <= 8) {
    return v;
  } else {
    const hn::Half<D> half;
    return fold<Of>(half, Of()(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

/// Lanes of a and b in turns, each the smaller, or the larger, of two; in every block.
template <class Of>
HWY_INLINE V16 pair(V16 a, V16 b) {
  const D16 d;
  return Of()(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
}

/// Lane k is the smallest, or the largest, lane of pixels[k].
template <class Of>
HWY_INLINE VBlock extreme(const std::array<V16, kPixels>& pixels) {
  const auto& p = pixels;
  const V16 even = pair<Of>(pair<Of>(p[0], p[4]), pair<Of>(p[2], p[6]));
  const V16 odd = pair<Of>(pair<Of>(p[1], p[5]), pair<Of>(p[3], p[7]));
  return fold<Of>(D16(), pair<Of>(even, odd));
}

/// The sums from the winner + 2 down, by pixel -> by neighbour.
HWY_INLINE void store_around(const std::array<VBlock, kPixels>& pixels, const SelectedRow& out,
                             int x) {
  const Block d;
  // Pixels that are 4, 2, 1 apart side by side: then all of one neighbour are.
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

/// Lanes, plus 1: 0 is none.
constexpr auto kNumbers = [] {
  std::array<std::uint16_t, 256> values{};
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i + 1);
  return values;
}();
/// Where a winner in lane 256 and its neighbours are.
constexpr auto kNeighbours = [] {
  std::array<std::uint16_t, 2 * 256 + kLaneGroup> values{};
  for (const std::size_t i : {255U, 256U, 257U}) values[i] = kMost;
  return values;
}();

/// Pixels of a row, kPixels at a time, in three steps.
template <int kGroups>
struct SelectLeft {
  const SumRing sums;
  const SelectedRow out;
  alignas(16) std::array<std::uint16_t, 2 * kPixels> ends{};  // of x: at x % (2 * kPixels)

  static constexpr int kLanes = static_cast<int>(hn::MaxLanes(D16()));
  HWY_INLINE int padded() const { return kGroups > 0 ? kGroups * kLaneGroup : sums.padded; }

  HWY_INLINE void winner_sums(int x) const {
    const D16 d;
    std::array<V16, kPixels> pixels;
    const std::uint16_t* s = sums.row(x);
    for (std::size_t k = 0; k < kPixels; ++k, s += sums.pitch) {
      pixels[k] = hn::LoadU(d, s);
      for (int i = kLanes; i < padded(); i += kLanes) {
        pixels[k] = hn::Min(pixels[k], hn::LoadU(d, s + i));
      }
    }
    hn::StoreU(extreme<Smaller>(pixels), Block(), out.winner_sum + x);
  }

  /// The lowest disparities with these sums; their lanes, the last ones, + 1 go into `ends`.
  HWY_INLINE void winners(int x) {
    const D16 d;
    const Block block;
    const hn::Rebind<std::uint8_t, Block> bytes;
    std::array<V16, kPixels> pixels;
    const std::uint16_t* s = sums.row(x);
    for (std::size_t k = 0; k < kPixels; ++k, s += sums.pitch) {
      const auto sum = hn::Set(d, out.winner_sum[x + static_cast<int>(k)]);
      pixels[k] = hn::Zero(d);
      for (int i = 0; i < padded(); i += kLanes) {
        const auto number = hn::LoadU(d, &kNumbers[static_cast<std::size_t>(i)]);
        const auto wins = hn::Eq(hn::LoadU(d, s + i), sum);
        pixels[k] = hn::Max(pixels[k], hn::IfThenElseZero(wins, number));
      }
    }
    const auto end = extreme<Larger>(pixels);
    hn::Store(end, block, &ends[static_cast<std::size_t>(x) % ends.size()]);
    const auto winner = hn::Sub(hn::Set(block, static_cast<std::uint16_t>(padded())), end);
    const auto signed_winner = hn::BitCast(hn::RebindToSigned<Block>(), winner);
    hn::StoreU(hn::DemoteTo(bytes, signed_winner), bytes, out.winner + x);
  }

  HWY_INLINE void rivals(int x) const {
    const D16 d;
    std::array<V16, kPixels> pixels;
    std::array<VBlock, kPixels> around;
    const std::uint16_t* end = &ends[static_cast<std::size_t>(x) % ends.size()];
    const std::uint16_t* s = sums.row(x);
    for (std::size_t k = 0; k < kPixels; ++k, s += sums.pitch) {
      const std::uint16_t* neighbours = &kNeighbours[std::size_t{257} - end[k]];
      pixels[k] = hn::Or(hn::LoadU(d, s), hn::LoadU(d, neighbours));
      for (int i = kLanes; i < padded(); i += kLanes) {
        const auto others = hn::Or(hn::LoadU(d, s + i), hn::LoadU(d, neighbours + i));
        pixels[k] = hn::Min(pixels[k], others);
      }
      around[k] = hn::LoadU(Block(), s + end[k] - 3);
    }
    hn::StoreU(extreme<Smaller>(pixels), Block(), out.runner_up_sum + x);
    store_around(around, out, x);
  }

  /// Each step is for other pixels than the one before, for whose end it would wait.
  HWY_INLINE void run(int x0, int x1) {
    constexpr int kStep = static_cast<int>(kPixels);
    for (int x = x0; x < x1 + 2 * kStep; x += kStep) {
      if (x < x1) winner_sums(x);
      if (x0 < x && x < x1 + kStep) winners(x - kStep);
      if (x0 + kStep < x) rivals(x - 2 * kStep);
    }
  }
};

void select_left(const SumRing& sums, int x0, int x1, const SelectedRow& out) {
  switch (sums.padded / kLaneGroup) {
    case 1:
      return SelectLeft<1>{sums, out}.run(x0, x1);
    case 2:
      return SelectLeft<2>{sums, out}.run(x0, x1);
    case 4:
      return SelectLeft<4>{sums, out}.run(x0, x1);
    default:
      return SelectLeft<0>{sums, out}.run(x0, x1);
  }
}

constexpr std::size_t kParts = kLaneGroup / hn::MaxLanes(D16());

/// The running minimum of right pixels, and the left pixels that have it.
struct Rightmost {
  std::array<V16, kParts> least, partner;

  Rightmost() {
    least.fill(hn::Set(D16(), kMost));
    partner.fill(hn::Zero(D16()));
  }
  /// Left pixel `number` has these sums.
  HWY_INLINE void see(const std::uint16_t* sum, V16 number) {
    const D16 d;
    for (std::size_t k = 0; k < kParts; ++k) {
      const auto smaller = hn::Min(least[k], hn::LoadU(d, sum + k * hn::Lanes(d)));
      partner[k] = hn::IfThenElse(hn::Eq(smaller, least[k]), partner[k], number);
      least[k] = smaller;
    }
  }
  /// What another one has seen; of equal sums the left pixel further left.
  HWY_INLINE void join(const Rightmost& other) {
    for (std::size_t k = 0; k < kParts; ++k) {
      const auto smaller = hn::Min(least[k], other.least[k]);
      const auto first = hn::Min(partner[k], other.partner[k]);
      const auto here = hn::Eq(smaller, least[k]), there = hn::Eq(smaller, other.least[k]);
      const auto one = hn::IfThenElse(here, partner[k], other.partner[k]);
      partner[k] = hn::IfThenElse(hn::And(here, there), first, one);
      least[k] = smaller;
    }
  }
};

/// Left pixels x .. end - 1, whose rows follow one another; lane 0 is right pixel `first`. Every
/// other one is for `odd`: then none waits for the one before.
HWY_INLINE void see_partners(const SumRing& sums, int first, int x, int end, Rightmost& even,
                             Rightmost& odd) {
  const D16 d;
  // Left pixel x is the partner of right pixels x - range + 1 .. x, and 0xFFFF for the others.
  const std::uint16_t* sum = sums.row(x) + (first - x + sums.padded - 1);
  const std::ptrdiff_t step = sums.pitch - 1;
  auto number = hn::Set(d, static_cast<std::uint16_t>(x));
  const auto one = hn::Set(d, std::uint16_t{1});
  for (; x < end - 1; x += 2, sum += 2 * step) {
    const auto next = hn::Add(number, one);
    even.see(sum, number);
    odd.see(sum + step, next);
    number = hn::Add(next, one);
  }
  if (x < end) even.see(sum, number);
}

void select_right(const SumRing& sums, int x0, int width, std::uint8_t* right_winner) {
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const hn::RebindToSigned<D16> d16s;
  const int end = std::min(x0 + kLaneGroup + sums.range - 1, width);
  const int wrap = (x0 | sums.mask) + 1;  // there the ring begins anew
  Rightmost best, odd;
  see_partners(sums, x0, x0, std::min(end, wrap), best, odd);
  if (wrap < end) see_partners(sums, x0, wrap, end, best, odd);
  best.join(odd);
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

void select_left(const SumRing& sums, int x0, int x1, const SelectedRow& out) {
  HWY_DYNAMIC_DISPATCH(select_left)(sums, x0, x1, out);
}
void select_right(const SumRing& sums, int x0, int width, std::uint8_t* right_winner) {
  HWY_DYNAMIC_DISPATCH(select_right)(sums, x0, width, right_winner);
}

}  // namespace fpga_stereo::simd
#endif
