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

/// Lanes of a and b in turns, each the smaller of two.
HWY_INLINE VBlock pair(VBlock a, VBlock b) {
  const Block d;
  return hn::Min(hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b));
}

/// Lane k is the smallest lane of blocks[k].
HWY_INLINE VBlock smallest(const std::array<VBlock, kPixels>& blocks) {
  const VBlock even = pair(pair(blocks[0], blocks[4]), pair(blocks[2], blocks[6]));
  const VBlock odd = pair(pair(blocks[1], blocks[5]), pair(blocks[3], blocks[7]));
  return pair(even, odd);
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
    for (int i = -1; i <= 1; ++i) neighbours[static_cast<std::size_t>(256 + i)] = kMost;
  }
};

void select_left(const SumRing& sums, int x0, int x1, const SelectedRow& out) {
  static const Tables tables;
  const D16 d;
  const Block block;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const std::uint16_t* disparities =
      &tables.disparities[static_cast<std::size_t>(256 - sums.padded)];
  const auto most = hn::Set(d, kMost);
  for (int x = x0; x < x1; x += kPixels) {
    std::array<VBlock, kPixels> blocks;
    for (int k = 0; k < kPixels; ++k) {
      const std::uint16_t* s = sums.row(x + k);
      V16 least = hn::LoadU(d, s);
      for (int i = lanes; i < sums.padded; i += lanes) least = hn::Min(least, hn::LoadU(d, s + i));
      blocks[static_cast<std::size_t>(k)] = fold(d, least);
    }
    hn::StoreU(smallest(blocks), block, out.winner_sum + x);

    // The lowest of the disparities that have this sum.
    for (int k = 0; k < kPixels; ++k) {
      const std::uint16_t* s = sums.row(x + k);
      const auto sum = hn::Set(d, out.winner_sum[x + k]);
      V16 least = most;
      for (int i = 0; i < sums.padded; i += lanes) {
        const auto wins = hn::Eq(hn::LoadU(d, s + i), sum);
        least = hn::Min(least, hn::IfThenElse(wins, hn::LoadU(d, disparities + i), most));
      }
      blocks[static_cast<std::size_t>(k)] = fold(d, least);
    }
    alignas(16) std::array<std::uint16_t, kPixels> winners;
    hn::Store(smallest(blocks), block, winners.data());

    for (int k = 0; k < kPixels; ++k) {
      const std::uint16_t* s = sums.row(x + k);
      const int lane = sums.padded - 1 - winners[static_cast<std::size_t>(k)];  // of the winner
      const std::uint16_t* neighbours = &tables.neighbours[static_cast<std::size_t>(256 - lane)];
      V16 least = most;
      for (int i = 0; i < sums.padded; i += lanes) {
        least = hn::Min(least, hn::Or(hn::LoadU(d, s + i), hn::LoadU(d, neighbours + i)));
      }
      blocks[static_cast<std::size_t>(k)] = fold(d, least);
      out.winner[x + k] = static_cast<std::uint8_t>(winners[static_cast<std::size_t>(k)]);
      for (int n = 0; n < 5; ++n) out.around[n][x + k] = s[lane + 2 - n];
    }
    hn::StoreU(smallest(blocks), block, out.rival_sum + x);
  }
}

void select_right(const SumRing& sums, int x0, int width, std::uint8_t* right_winner) {
  const D16 d;
  const hn::Rebind<std::uint8_t, D16> d8;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (int first = x0; first < x0 + kLaneGroup; first += lanes) {
    // Left pixel x is the partner of the right pixels x - range + 1 .. x, and 0xFFFF for others.
    const int end = std::min(first + lanes + sums.range - 1, width);
    V16 least = hn::Set(d, kMost);
    V16 partner = hn::Zero(d);
    for (int x = first; x < end; ++x) {
      const auto sum = hn::LoadU(d, sums.row(x) + (first - x + sums.padded - 1));
      const auto smaller = hn::Min(least, sum);
      const auto stays = hn::Eq(smaller, least);
      partner = hn::IfThenElse(stays, partner, hn::Set(d, static_cast<std::uint16_t>(x)));
      least = smaller;
    }
    const auto disparity = hn::Sub(partner, hn::Iota(d, static_cast<std::uint16_t>(first)));
    const hn::RebindToSigned<D16> d16s;
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
