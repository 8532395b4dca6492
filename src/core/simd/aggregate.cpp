#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/aggregate.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/aggregate.hpp"
#include "core/simd/lanes-inl.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

void penalties(const std::uint8_t* a, const std::uint8_t* b, int count, const Parameters& p,
               std::uint8_t* p2) {
  const Bytes d;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto set = [&](int value) HWY_ATTR { return hn::Set(d, static_cast<std::uint8_t>(value)); };
  const auto edge = set(p.sgm_edge), strong_edge = set(p.sgm_strong_edge);
  const auto flat = set(p.sgm_p2), at_edge = set(p.sgm_p2_edge);
  const auto at_strong_edge = set(p.sgm_p2_strong_edge);
  for (int i = 0; i < count; i += step) {
    const auto x = hn::LoadU(d, a + i), y = hn::LoadU(d, b + i);
    const auto difference = absolute_difference(x, y);
    const auto penalty =
        hn::IfThenElse(hn::Lt(difference, edge), flat,
                       hn::IfThenElse(hn::Lt(difference, strong_edge), at_edge, at_strong_edge));
    hn::StoreU(penalty, d, p2 + i);
  }
}

/// Goes through the path costs of a pixel, a vector at a time. kLanes > 0 fixes the lanes per pixel
/// at compile time.
template <int kLanes>
class Steps {
 public:
  HWY_INLINE Steps(const std::uint8_t* path, int lanes, VBytes p1)
      : path_(path), lanes_(kLanes > 0 ? kLanes : lanes), p1_(p1) {
    const Bytes d;
    below_ = hn::Set(d, kNone);
    here_ = hn::LoadU(d, path);
    here_p1_ = hn::Add(here_, p1_);
  }

  /// Returns min(L(d), L(d - 1) + P1, L(d + 1) + P1) for lanes i .., which must come in order.
  HWY_INLINE VBytes next(int i) {
    const Bytes d;
    const int following = i + static_cast<int>(hn::Lanes(d));
    auto above = hn::Set(d, kNone), above_p1 = above;
    if (following < lanes_) {
      above = hn::LoadU(d, path_ + following);
      above_p1 = hn::Add(above, p1_);
    }
    const auto beside = hn::Min(from_below(here_p1_, below_), from_above(here_p1_, above_p1));
    const auto smallest = hn::Min(here_, beside);
    below_ = here_p1_;
    here_ = above;
    here_p1_ = above_p1;
    return smallest;
  }

 private:
  static constexpr std::uint8_t kNone = 0xFF;  // outside the search range
  const std::uint8_t* const path_;
  const int lanes_;
  const VBytes p1_;
  VBytes below_, here_, here_p1_;  // with P1, without, with
};

/// With kPair, also the paths from the upper right. L is at most 18, and P2 at most 15, so N need
/// not be limited to 15 as in the definition: min(N, P2) is the same.
template <int kLanes, bool kPair>
HWY_INLINE void vertical_paths_of(const PathRow row, const std::uint8_t* p2,
                                  const std::uint8_t* p2_right, const std::uint8_t* above,
                                  const std::uint8_t* smallest_above, std::uint8_t* vertical,
                                  std::uint8_t* smallest) {
  constexpr int kPixels = 16;  // at a time: their smallest costs are found together
  const Bytes d;
  const int lanes = kLanes > 0 ? kLanes : row.lanes, step = static_cast<int>(hn::Lanes(d));
  const auto p1 = hn::Set(d, static_cast<std::uint8_t>(row.p1));
  HWY_ALIGN std::uint8_t blocks[16 * kPixels] = {};
  std::ptrdiff_t at = 0;
  for (int x0 = 0; x0 < row.width; x0 += kPixels) {
    const int end = std::min(x0 + kPixels, row.width);
    std::uint8_t* block = blocks;
    for (int x = x0; x < end; ++x, at += lanes, block += 16) {
      const auto base = hn::Set(d, smallest_above[x]), jump = hn::Set(d, p2[x]);
      auto min = hn::Set(d, std::uint8_t{0xFF});
      Steps<kLanes> steps(above + at, lanes, p1);
      if constexpr (kPair) {
        Steps<kLanes> steps_right(above + at + lanes, lanes, p1);
        const auto base_right = hn::Set(d, smallest_above[x + 1]);
        const auto jump_right = hn::Set(d, p2_right[x]);
        for (int i = 0; i < lanes; i += step) {
          const auto straight = hn::Min(hn::Sub(steps.next(i), base), jump);
          const auto diagonal = hn::Min(hn::Sub(steps_right.next(i), base_right), jump_right);
          const auto best = hn::ShiftRightSame(hn::Add(straight, diagonal), 1);
          const auto cost = hn::Add(best, hn::LoadU(d, row.costs + at + i));
          hn::StoreU(cost, d, vertical + at + i);
          min = hn::Min(min, cost);
        }
      } else {
        for (int i = 0; i < lanes; i += step) {
          const auto best = hn::Min(hn::Sub(steps.next(i), base), jump);
          const auto cost = hn::Add(best, hn::LoadU(d, row.costs + at + i));
          hn::StoreU(cost, d, vertical + at + i);
          min = hn::Min(min, cost);
        }
      }
      hn::StoreU(smallest_block(min), Block8(), block);
    }
    hn::StoreU(smallest_of_blocks(blocks), Block8(), smallest + x0);
  }
}

void vertical_paths(const PathRow& row, const std::uint8_t* p2, const std::uint8_t* p2_right,
                    const std::uint8_t* above, const std::uint8_t* smallest_above,
                    std::uint8_t* vertical, std::uint8_t* smallest) {
  if (p2_right != nullptr) {
    if (row.lanes == 64) {
      return vertical_paths_of<64, true>(row, p2, p2_right, above, smallest_above, vertical,
                                         smallest);
    }
    return vertical_paths_of<0, true>(row, p2, p2_right, above, smallest_above, vertical, smallest);
  }
  switch (row.lanes) {
    case 64:
      return vertical_paths_of<64, false>(row, p2, nullptr, above, smallest_above, vertical,
                                          smallest);
    case 128:
      return vertical_paths_of<128, false>(row, p2, nullptr, above, smallest_above, vertical,
                                           smallest);
    default:
      return vertical_paths_of<0, false>(row, p2, nullptr, above, smallest_above, vertical,
                                         smallest);
  }
}

/// A path along a row. Costs are kept relative to M(n - 3), which is known early enough not to wait
/// for: state(n, d) = L(n, d) - M(n - 3). Its minimum is M(n) - M(n - 3). M is counted modulo 256,
/// as only differences matter.
struct RowPath {
  VBytes m1, m2, m3, m4;  // M(n - 1) .. M(n - 4)

  HWY_INLINE RowPath() {
    const Bytes d;
    m1 = m2 = m3 = m4 = hn::Zero(d);
  }

  /// Advances by a pixel. Returns the smallest state of each block.
  template <int kLanes>
  HWY_INLINE VBlock8 advance(const std::uint8_t* costs, std::uint8_t penalty, VBytes p1,
                             int lanes_in, std::uint8_t* state, const std::uint8_t* addend,
                             std::uint8_t* sums) const {
    const Bytes d;
    const int lanes = kLanes > 0 ? kLanes : lanes_in, step = static_cast<int>(hn::Lanes(d));
    const auto jump = hn::Set(d, penalty);
    const auto rise = hn::Sub(m3, m4), lead = hn::Sub(m1, m3);
    auto min = hn::Set(d, std::uint8_t{0xFF});
    Steps<kLanes> steps(state, lanes, p1);
    for (int i = 0; i < lanes; i += step) {
      const auto best = hn::Min(hn::Sub(steps.next(i), rise), jump);
      const auto cost = hn::Add(best, hn::LoadU(d, costs + i));
      min = hn::Min(min, cost);
      hn::StoreU(cost, d, state + i);
      hn::StoreU(hn::SaturatedAdd(hn::LoadU(d, addend + i), hn::Sub(cost, lead)), d, sums + i);
    }
    return smallest_block(min);
  }
  /// Takes the smallest state of this pixel, in every lane.
  HWY_INLINE void push(VBytes smallest) {
    const auto m = hn::Add(m3, smallest);
    m4 = m3;
    m3 = m2;
    m2 = m1;
    m1 = m;
  }
};

/// Returns lane kLane in every lane.
template <int kLane, class D = Bytes>
HWY_INLINE hn::Vec<D> spread(VBlock8 v) {
  const Block8 d;
  const auto block = hn::TableLookupBytes(v, hn::Set(d, std::uint8_t{kLane}));
  if constexpr (hn::MaxLanes(D()) <= 16) {
    return block;
  } else {
    return hn::Combine(D(), block, block);
  }
}

/// Takes the smallest bytes of two blocks.
HWY_INLINE void push_smallest(VBlock8 left_min, VBlock8 right_min, RowPath& left, RowPath& right) {
  const Block8 d;
  auto min = smallest_pairs(left_min, right_min);
  min = hn::Min(min, hn::CombineShiftRightBytes<8>(d, min, min));
  min = hn::Min(min, hn::CombineShiftRightBytes<4>(d, min, min));
  min = hn::Min(min, hn::CombineShiftRightBytes<2>(d, min, min));
  left.push(spread<0>(min));
  right.push(spread<1>(min));
}

/// What both paths of a row share.
struct RowPaths {
  const PathRow row;
  const std::uint8_t *p2, *vertical;
  std::uint8_t* state;
  const PathSums sums;
  RowPath left, right;

  HWY_INLINE RowPaths(const PathRow& path_row, const std::uint8_t* penalties,
                      const std::uint8_t* vertical_costs, std::uint8_t* states,
                      const PathSums& path_sums)
      : row(path_row), p2(penalties), vertical(vertical_costs), state(states), sums(path_sums) {}

  /// Returns what a path adds to at pixel `x`: the first to get there adds to the contribution from
  /// above, the second to the sum of the two.
  template <int kLanes>
  HWY_INLINE const std::uint8_t* addend(int x, bool is_first) const {
    const int lanes = kLanes > 0 ? kLanes : row.lanes;
    return is_first ? vertical + static_cast<std::ptrdiff_t>(x) * lanes : sums.column(x);
  }

  /// Starts a path at the end of the row, where its costs are C.
  template <int kLanes>
  HWY_INLINE void start(int x, bool is_first, std::uint8_t* path) const {
    const Bytes d;
    const int lanes = kLanes > 0 ? kLanes : row.lanes, step = static_cast<int>(hn::Lanes(d));
    const std::uint8_t* const from = addend<kLanes>(x, is_first);
    for (int i = 0; i < lanes; i += step) {
      const auto cost = hn::LoadU(d, row.costs + static_cast<std::ptrdiff_t>(x) * lanes + i);
      hn::StoreU(cost, d, path + i);
      hn::StoreU(hn::SaturatedAdd(hn::LoadU(d, from + i), cost), d, sums.column(x) + i);
    }
  }

  /// Advances both paths from pixel `begin` of each to `end`. They take turns, so that neither
  /// waits for itself.
  template <int kLanes, bool kLeftIsFirst, bool kRightIsFirst>
  HWY_INLINE void advance(int begin, int end) {
    const int lanes = kLanes > 0 ? kLanes : row.lanes, width = row.width;
    const auto p1 = hn::Set(Bytes(), static_cast<std::uint8_t>(row.p1));
    for (int n = begin; n < end; ++n) {
      const int x = width - 1 - n;
      const auto left_min = left.template advance<kLanes>(
          row.costs + static_cast<std::ptrdiff_t>(n) * lanes, p2[n], p1, lanes, state,
          addend<kLanes>(n, kLeftIsFirst), sums.column(n));
      const auto right_min = right.template advance<kLanes>(
          row.costs + static_cast<std::ptrdiff_t>(x) * lanes, p2[x + 1], p1, lanes, state + lanes,
          addend<kLanes>(x, kRightIsFirst), sums.column(x));
      push_smallest(left_min, right_min, left, right);
    }
  }

  template <int kLanes>
  HWY_INLINE void run() {
    const int width = row.width, half = width / 2;
    start<kLanes>(0, true, state);
    start<kLanes>(width - 1, width > 1, state + (kLanes > 0 ? kLanes : row.lanes));
    advance<kLanes, true, true>(1, half);
    if (width % 2 != 0 && width > 1) advance<kLanes, true, false>(half, half + 1);
    advance<kLanes, false, false>((width + 1) / 2, width);
  }

  HWY_INLINE void run_left() {
    const auto p1 = hn::Set(Bytes(), static_cast<std::uint8_t>(row.p1));
    start<0>(0, true, state);
    for (int n = 1; n < row.width; ++n) {
      const auto min =
          left.template advance<0>(row.costs + static_cast<std::ptrdiff_t>(n) * row.lanes, p2[n],
                                   p1, row.lanes, state, addend<0>(n, true), sums.column(n));
      push_smallest(min, min, left, right);
    }
  }
};

void horizontal_paths(const PathRow& row, const std::uint8_t* p2, bool both,
                      const std::uint8_t* vertical, std::uint8_t* state, const PathSums& sums) {
  RowPaths paths(row, p2, vertical, state, sums);
  if (!both) return paths.run_left();
  switch (row.lanes) {
    case 64:
      return paths.run<64>();
    case 128:
      return paths.run<128>();
    default:
      return paths.run<0>();
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(penalties);
HWY_EXPORT(vertical_paths);
HWY_EXPORT(horizontal_paths);

void penalties(const std::uint8_t* a, const std::uint8_t* b, int count, const Parameters& p,
               std::uint8_t* p2) {
  HWY_DYNAMIC_DISPATCH(penalties)(a, b, count, p, p2);
}
void vertical_paths(const PathRow& row, const std::uint8_t* p2, const std::uint8_t* p2_right,
                    const std::uint8_t* above, const std::uint8_t* smallest_above,
                    std::uint8_t* vertical, std::uint8_t* smallest) {
  HWY_DYNAMIC_DISPATCH(vertical_paths)
  (row, p2, p2_right, above, smallest_above, vertical, smallest);
}
void horizontal_paths(const PathRow& row, const std::uint8_t* p2, bool both,
                      const std::uint8_t* vertical, std::uint8_t* state, const PathSums& sums) {
  HWY_DYNAMIC_DISPATCH(horizontal_paths)(row, p2, both, vertical, state, sums);
}

void PathSumsBuffer::create(int width, int disparity_range) {
  const int lanes = lanes_per_pixel(disparity_range), pitch = lanes + kLaneGroup;
  if (sums_.width == width && sums_.range == disparity_range) return;
  bytes_.create(1, kLaneGroup + width * pitch);
  bytes_ = kNoPathSum;
  sums_ = {bytes_[0] + kLaneGroup, pitch, width, disparity_range, lanes};
}

void VerticalCosts::create(int width, int disparity_range) {
  const int lanes = lanes_per_pixel(disparity_range);
  if (costs.rows == width + 1 && costs.cols == lanes) return;
  costs.create(width + 1, lanes);
  costs = 0;
  smallest.assign(static_cast<std::size_t>(width) + kBorder, 0);
}

void VerticalPaths::start(int width, const Parameters& p) {
  parameters_ = p;
  p2_.assign(static_cast<std::size_t>(width) + kBorder, 0);
  p2_right_.assign(static_cast<std::size_t>(width) + kBorder, 0);
}

void VerticalPaths::next(const cv::Mat1b& guide, int y, const std::uint8_t* costs,
                         const VerticalCosts& above, VerticalCosts& row) {
  const int width = guide.cols, lanes = row.costs.cols;
  const bool is_pair = parameters_.sgm_build == SgmBuild::kSmall;
  // Without a row above, P2 is 0, and so is every step.
  if (y > 0) {
    penalties(guide[y], guide[y - 1], width, parameters_, p2_.data());
    if (is_pair) {
      penalties(guide[y], guide[y - 1] + 1, width, parameters_, p2_right_.data());
      p2_right_[static_cast<std::size_t>(width) - 1] = 0;  // there is no pixel to step from
    }
  }
  vertical_paths({costs, width, lanes, parameters_.sgm_p1}, p2_.data(),
                 is_pair ? p2_right_.data() : nullptr, above.costs[0], above.smallest.data(),
                 row.costs[0], row.smallest.data());
}

void HorizontalPaths::start(int width, const Parameters& p) {
  parameters_ = p;
  p2_.assign(static_cast<std::size_t>(width) + kBorder, 0);
  state_.resize(std::size_t{2} * static_cast<std::size_t>(lanes_per_pixel(p.disparity_range)));
}

void HorizontalPaths::next(const cv::Mat1b& guide, int y, const std::uint8_t* costs,
                           const VerticalCosts& vertical, const PathSums& sums) {
  penalties(guide[y] + 1, guide[y], sums.width - 1, parameters_, p2_.data() + 1);
  horizontal_paths({costs, sums.width, sums.lanes, parameters_.sgm_p1}, p2_.data(),
                   parameters_.sgm_build == SgmBuild::kFull, vertical.costs[0], state_.data(),
                   sums);
}

}  // namespace fpga_stereo::simd
#endif
