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

constexpr int kPixels = 8;  // that are worked on at a time
constexpr std::uint16_t kMost = 0xFFFF;

/// The smallest lane of every position in a block.
template <class D>
HWY_INLINE VBlock fold(D /*d*/, hn::Vec<D> v) {
  if constexpr (hn::MaxLanes(D()) <= 8) {
    return v;
  } else {
    const hn::Half<D> half;
    return fold(half, hn::Min(hn::LowerHalf(half, v), hn::UpperHalf(half, v)));
  }
}

/// Lanes of a and b in turns, each the smaller of two; in every block.
HWY_INLINE V16 pair(V16 a, V16 b) {
  const D16 d;
  return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
}

/// Lane k is the smallest lane of pixels[k].
HWY_INLINE VBlock smallest(const std::array<V16, kPixels>& pixels) {
  const V16 even = pair(pair(pixels[0], pixels[4]), pair(pixels[2], pixels[6]));
  const V16 odd = pair(pair(pixels[1], pixels[5]), pair(pixels[3], pixels[7]));
  return fold(D16(), pair(even, odd));
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

/// The disparities of lanes, and where a winner's neighbours are, as vectors to load.
struct Tables {
  std::array<std::uint16_t, 256 + kLaneGroup> disparities;  // 255 - i
  std::array<std::uint16_t, 2 * 256 + kLaneGroup> neighbours;
  Tables() {
    for (std::size_t i = 0; i < disparities.size(); ++i) {
      disparities[i] = static_cast<std::uint16_t>(255 - i);
    }
    neighbours.fill(0);
    for (const std::size_t i : {255U, 256U, 257U}) neighbours[i] = kMost;
  }
};

template <int kGroups>
HWY_INLINE void select_left_groups(const SumRing& sums, int x0, int x1, const SelectedRow& out) {
  static const Tables tables;
  const D16 d;
  const Block block;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const int padded = kGroups > 0 ? kGroups * kLaneGroup : sums.padded;
  const std::uint16_t* disparities = &tables.disparities[static_cast<std::size_t>(256 - padded)];
  const auto most = hn::Set(d, kMost);
  for (int x = x0; x < x1; x += kPixels) {
    std::array<V16, kPixels> pixels;
    std::array<VBlock, kPixels> around;
    for (int k = 0; k < kPixels; ++k) {
      const std::uint16_t* s = sums.row(x + k);
      V16 least = hn::LoadU(d, s);
      for (int i = lanes; i < padded; i += lanes) least = hn::Min(least, hn::LoadU(d, s + i));
      pixels[static_cast<std::size_t>(k)] = least;
    }
    hn::StoreU(smallest(pixels), block, out.winner_sum + x);

    // The lowest of the disparities that have this sum.
    for (int k = 0; k < kPixels; ++k) {
      const std::uint16_t* s = sums.row(x + k);
      const auto sum = hn::Set(d, out.winner_sum[x + k]);
      V16 least = most;
      for (int i = 0; i < padded; i += lanes) {
        const auto wins = hn::Eq(hn::LoadU(d, s + i), sum);
        least = hn::Min(least, hn::IfThenElse(wins, hn::LoadU(d, disparities + i), most));
      }
      pixels[static_cast<std::size_t>(k)] = least;
    }
    alignas(16) std::array<std::uint16_t, kPixels> winners;
    hn::Store(smallest(pixels), block, winners.data());

    for (int k = 0; k < kPixels; ++k) {
      const std::uint16_t* s = sums.row(x + k);
      const int lane = padded - 1 - winners[static_cast<std::size_t>(k)];  // of the winner
      const std::uint16_t* neighbours = &tables.neighbours[static_cast<std::size_t>(256 - lane)];
      V16 least = most;
      for (int i = 0; i < padded; i += lanes) {
        least = hn::Min(least, hn::Or(hn::LoadU(d, s + i), hn::LoadU(d, neighbours + i)));
      }
      pixels[static_cast<std::size_t>(k)] = least;
      out.winner[x + k] = static_cast<std::uint8_t>(winners[static_cast<std::size_t>(k)]);
      around[static_cast<std::size_t>(k)] = hn::LoadU(block, s + lane - 2);
    }
    hn::StoreU(smallest(pixels), block, out.rival_sum + x);
    store_around(around, out, x);
  }
}

void select_left(const SumRing& sums, int x0, int x1, const SelectedRow& out) {
  switch (sums.padded / kLaneGroup) {
    case 2:
      return select_left_groups<2>(sums, x0, x1, out);
    case 4:
      return select_left_groups<4>(sums, x0, x1, out);
    default:
      return select_left_groups<0>(sums, x0, x1, out);
  }
}

/// The running minimum of right pixels, and the left pixels that have it.
struct Rightmost {
  V16 least, partner;
};

/// Left pixels x .. end - 1, whose rows follow one another; lane 0 is right pixel `first`.
HWY_INLINE void see_partners(const SumRing& sums, int first, int x, int end, Rightmost& best) {
  const D16 d;
  // Left pixel x is the partner of right pixels x - range + 1 .. x, and 0xFFFF for the others.
  const std::uint16_t* sum = sums.row(x) + (first - x + sums.padded - 1);
  auto number = hn::Set(d, static_cast<std::uint16_t>(x));
  const auto one = hn::Set(d, std::uint16_t{1});
  for (; x < end; ++x, sum += sums.pitch - 1) {
    const auto smaller = hn::Min(best.least, hn::LoadU(d, sum));
    best.partner = hn::IfThenElse(hn::Eq(smaller, best.least), best.partner, number);
    best.least = smaller;
    number = hn::Add(number, one);
  }
}

void select_right(const SumRing& sums, int x0, int width, std::uint8_t* right_winner) {
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const hn::RebindToSigned<D16> d16s;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = x0; first < x0 + kLaneGroup; first += lanes) {
    const int end = std::min(first + lanes + sums.range - 1, width);
    const int wrap = (first | sums.mask) + 1;  // there the ring begins anew
    Rightmost best{hn::Set(d, kMost), hn::Zero(d)};
    see_partners(sums, first, first, std::min(end, wrap), best);
    if (wrap < end) see_partners(sums, first, wrap, end, best);
    const auto disparity = hn::Sub(best.partner, hn::Iota(d, static_cast<std::uint16_t>(first)));
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
