#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/select_paths.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/lanes-inl.hpp"
#include "core/simd/select_paths.hpp"
#include "core/simd/stages.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

using Words = hn::Repartition<std::uint16_t, Bytes>;

/// kNoPathSum at bytes 255 .. 257, to exclude a winner and its neighbours from the runners-up.
constexpr auto kWinnerMask = [] {
  std::array<std::uint8_t, 2 * 256 + kLaneGroup> values{};
  for (const std::size_t i : {255U, 256U, 257U}) values[i] = kNoPathSum;
  return values;
}();

/// Returns the smallest lane of a vector of words.
HWY_INLINE std::uint16_t smallest_word(hn::Vec<Words> v) {
  const hn::Repartition<std::uint16_t, Block8> block;
  return hn::GetLane(hn::MinOfLanes(block, fold<Smallest>(Words(), v)));
}

/// kLanes > 0 fixes the lanes per pixel at compile time.
template <int kLanes>
HWY_INLINE void select_left_of(const PathSums& sums_in, const SelectionRow& out_in) {
  constexpr int kPixels = 16;  // at a time: the sums of their runners-up are found together
  const PathSums sums = sums_in;
  const SelectionRow out = out_in;
  const Bytes d;
  const Words words;
  const int lanes = kLanes > 0 ? kLanes : sums.lanes, step = static_cast<int>(hn::Lanes(d));
  const auto descending =
      hn::Sub(hn::Set(d, static_cast<std::uint8_t>(lanes - 1)), hn::Iota(d, std::uint8_t{0}));
  const auto step_down = hn::Set(d, static_cast<std::uint8_t>(step));
  HWY_ALIGN std::uint8_t blocks[16 * kPixels] = {};
  HWY_ALIGN std::uint8_t runners_up[kPixels];
  for (int x0 = 0; x0 < sums.width; x0 += kPixels) {
    const int count = std::min(kPixels, sums.width - x0);
    for (int k = 0; k < count; ++k) {
      const std::uint8_t* const s = sums.column(x0 + k);
      // A word is 256 S + d: the smallest has the smallest sum, and of equal ones the lowest d.
      auto disparity = descending;
      auto smallest = hn::Set(words, std::uint16_t{0xFFFF});
      for (int i = 0; i < lanes; i += step) {
        const auto sum = hn::LoadU(d, s + i);
        const auto low = hn::BitCast(words, hn::InterleaveLower(d, disparity, sum));
        const auto high = hn::BitCast(words, hn::InterleaveUpper(d, disparity, sum));
        smallest = hn::Min(smallest, hn::Min(low, high));
        disparity = hn::Sub(disparity, step_down);
      }
      const std::uint16_t best = smallest_word(smallest);
      const int winner = best & 0xFF;
      out.winner[x0 + k] = static_cast<std::uint8_t>(winner);
      out.winner_sum[x0 + k] = best >> 8;
      const std::uint8_t* const excluded =
          &kWinnerMask[static_cast<std::size_t>(256 - (lanes - 1 - winner))];
      auto others = hn::Set(d, kNoPathSum);
      for (int i = 0; i < lanes; i += step) {
        others = hn::Min(others, hn::Or(hn::LoadU(d, s + i), hn::LoadU(d, excluded + i)));
      }
      hn::StoreU(smallest_block(others), Block8(), blocks + std::ptrdiff_t{16} * k);
    }
    hn::StoreU(smallest_of_blocks(blocks), Block8(), runners_up);
    std::copy_n(runners_up, count, out.runner_up_sum + x0);
  }
}

void select_left_pixels(const PathSums& sums, const SelectionRow& out) {
  if (sums.lanes == 64) return select_left_of<64>(sums, out);
  select_left_of<0>(sums, out);
}

/// The smallest sums of a vector of right pixels so far, and the left pixels that have them, modulo
/// 256.
struct RightPixels {
  VBytes sum, partner;

  HWY_INLINE RightPixels() {
    const Bytes d;
    sum = hn::Set(d, kNoPathSum);
    partner = hn::Zero(d);
  }
  HWY_INLINE void add(const std::uint8_t* sums, VBytes number) {
    const Bytes d;
    const auto candidate = hn::LoadU(d, sums);
    const auto smaller = hn::Min(sum, candidate);
    // Of equal sums, the left pixel further left stays.
    partner = hn::IfThenElse(hn::Eq(smaller, sum), partner, number);
    sum = smaller;
  }
};

void select_right_pixels(const PathSums& sums_in, std::uint8_t* right_winner) {
  const PathSums sums = sums_in;
  const Bytes d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto one = hn::Set(d, std::uint8_t{1});
  const std::ptrdiff_t diagonal = sums.pitch - 1;
  for (int first = 0; first < sums.width; first += 2 * step) {
    // Left pixel x is a partner of right pixels x - range + 1 .. x; its lanes for others hold
    // kNoPathSum. Two vectors of right pixels take turns.
    RightPixels pixels, next;
    const int end = std::min(first + 2 * step + sums.range - 1, sums.width);
    const std::uint8_t* sum = sums.column(first) + (sums.lanes - 1);
    auto number = hn::Set(d, static_cast<std::uint8_t>(first));
    // Beyond the lanes of a pixel and the kLaneGroup around them lies another pixel, so each vector
    // has left pixels of its own.
    const int both = std::min(first + step, end);
    const int last = std::min(first + step + sums.range - 1, end);
    int x = first;
    for (; x < both; ++x, sum += diagonal, number = hn::Add(number, one)) pixels.add(sum, number);
    for (; x < last; ++x, sum += diagonal, number = hn::Add(number, one)) {
      pixels.add(sum, number);
      next.add(sum + step, number);
    }
    for (; x < end; ++x, sum += diagonal, number = hn::Add(number, one)) {
      next.add(sum + step, number);
    }
    const auto store = [&](const RightPixels& from, int pixel) HWY_ATTR {
      const auto here = hn::Iota(d, static_cast<std::uint8_t>(pixel));
      hn::StoreU(hn::Sub(from.partner, here), d, right_winner + pixel);
    };
    store(pixels, first);
    store(next, first + step);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(select_left_pixels);
HWY_EXPORT(select_right_pixels);

void select_left_pixels(const PathSums& sums, const SelectionRow& out) {
  HWY_DYNAMIC_DISPATCH(select_left_pixels)(sums, out);
}
void select_right_pixels(const PathSums& sums, std::uint8_t* right_winner) {
  HWY_DYNAMIC_DISPATCH(select_right_pixels)(sums, right_winner);
}

void select(const PathSums& sums, const SelectionRow& out) {
  select_left_pixels(sums, out);
  select_right_pixels(sums, out.right_winner);
}

}  // namespace fpga_stereo::simd
#endif
