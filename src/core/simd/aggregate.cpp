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
    const auto difference = hn::Or(hn::SaturatedSub(x, y), hn::SaturatedSub(y, x));
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

/// With kPair, also the path from the upper right.
template <int kLanes, bool kPair>
HWY_INLINE void vertical(const std::uint8_t* costs, const std::uint8_t* p2,
                         const std::uint8_t* p2_right, int p1_in, std::uint8_t* paths,
                         const PathSums& sums_in) {
  constexpr int kPixels = 16;  // at a time: their smallest costs are found together
  const PathSums sums = sums_in;
  const Bytes d;
  const int lanes = kLanes > 0 ? kLanes : sums.lanes, step = static_cast<int>(hn::Lanes(d));
  const auto p1 = hn::Set(d, static_cast<std::uint8_t>(p1_in));
  const auto max_path = hn::Set(d, static_cast<std::uint8_t>(kSgmMaxPath));
  HWY_ALIGN std::uint8_t blocks[16 * kPixels] = {};
  HWY_ALIGN std::uint8_t smallest[kPixels];
  for (int x0 = 0; x0 < sums.width; x0 += kPixels) {
    const int count = std::min(kPixels, sums.width - x0);
    for (int k = 0; k < count; ++k) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x0 + k) * lanes;
      std::uint8_t* const out = sums.column(x0 + k);
      const auto jump = hn::Set(d, p2[x0 + k]);
      auto min = hn::Set(d, std::uint8_t{0xFF});
      Steps<kLanes> steps(paths + at, lanes, p1);
      if constexpr (kPair) {
        Steps<kLanes> steps_right(paths + at + lanes, lanes, p1);
        const auto jump_right = hn::Set(d, p2_right[x0 + k]);
        for (int i = 0; i < lanes; i += step) {
          const auto best =
              hn::Add(hn::Min(steps.next(i), jump), hn::Min(steps_right.next(i), jump_right));
          const auto cost = hn::Add(hn::ShiftRightSame(best, 1), hn::LoadU(d, costs + at + i));
          hn::StoreU(cost, d, out + i);
          min = hn::Min(min, cost);
        }
      } else {
        for (int i = 0; i < lanes; i += step) {
          const auto cost = hn::Add(hn::Min(steps.next(i), jump), hn::LoadU(d, costs + at + i));
          hn::StoreU(cost, d, out + i);
          min = hn::Min(min, cost);
        }
      }
      hn::StoreU(smallest_block(min), Block8(), blocks + 16 * k);
    }
    hn::StoreU(smallest_of_blocks(blocks), Block8(), smallest);
    const std::uint8_t* cost = sums.column(x0);
    std::uint8_t* path = paths + static_cast<std::ptrdiff_t>(x0) * lanes;
    for (int k = 0; k < count; ++k, cost += sums.pitch, path += lanes) {
      const auto min = hn::Set(d, smallest[k]);
      for (int i = 0; i < lanes; i += step) {
        hn::StoreU(hn::Min(hn::Sub(hn::LoadU(d, cost + i), min), max_path), d, path + i);
      }
    }
  }
}

void vertical_path(const std::uint8_t* costs, const std::uint8_t* p2, int p1, std::uint8_t* paths,
                   const PathSums& sums) {
  switch (sums.lanes) {
    case 64:
      return vertical<64, false>(costs, p2, nullptr, p1, paths, sums);
    case 128:
      return vertical<128, false>(costs, p2, nullptr, p1, paths, sums);
    default:
      return vertical<0, false>(costs, p2, nullptr, p1, paths, sums);
  }
}

void vertical_path_pair(const std::uint8_t* costs, const std::uint8_t* p2,
                        const std::uint8_t* p2_right, int p1, std::uint8_t* paths,
                        const PathSums& sums) {
  if (sums.lanes == 64) return vertical<64, true>(costs, p2, p2_right, p1, paths, sums);
  vertical<0, true>(costs, p2, p2_right, p1, paths, sums);
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
                             int lanes_in, std::uint8_t* state, std::uint8_t* sums) const {
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
      hn::StoreU(hn::SaturatedAdd(hn::LoadU(d, sums + i), hn::Sub(cost, lead)), d, sums + i);
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

template <int kLanes, bool kBoth>
HWY_INLINE void horizontal(const std::uint8_t* costs, const std::uint8_t* p2, int p1_in,
                           std::uint8_t* state, const PathSums& sums_in) {
  const PathSums sums = sums_in;
  const Bytes d;
  const int lanes = kLanes > 0 ? kLanes : sums.lanes, width = sums.width;
  const int step = static_cast<int>(hn::Lanes(d));
  const auto p1 = hn::Set(d, static_cast<std::uint8_t>(p1_in));
  const auto costs_of = [&](int x) { return costs + static_cast<std::ptrdiff_t>(x) * lanes; };
  const auto begin = [&](int x, std::uint8_t* path) HWY_ATTR {
    for (int i = 0; i < lanes; i += step) {
      const auto cost = hn::LoadU(d, costs_of(x) + i);
      hn::StoreU(cost, d, path + i);
      std::uint8_t* const sum = sums.column(x) + i;
      hn::StoreU(hn::SaturatedAdd(hn::LoadU(d, sum), cost), d, sum);
    }
  };
  // Both paths take turns, so that neither waits for itself.
  std::uint8_t *const left_state = state, *const right_state = state + lanes;
  RowPath left, right;
  begin(0, left_state);
  if (kBoth) begin(width - 1, right_state);
  for (int n = 1; n < width; ++n) {
    const auto left_min =
        left.template advance<kLanes>(costs_of(n), p2[n], p1, lanes, left_state, sums.column(n));
    if constexpr (kBoth) {
      const int x = width - 1 - n;
      const auto right_min = right.template advance<kLanes>(costs_of(x), p2[x + 1], p1, lanes,
                                                            right_state, sums.column(x));
      push_smallest(left_min, right_min, left, right);
    } else {
      push_smallest(left_min, left_min, left, right);
    }
  }
}

void horizontal_paths(const std::uint8_t* costs, const std::uint8_t* p2, int p1, bool both,
                      std::uint8_t* state, const PathSums& sums) {
  if (!both) return horizontal<0, false>(costs, p2, p1, state, sums);
  switch (sums.lanes) {
    case 64:
      return horizontal<64, true>(costs, p2, p1, state, sums);
    case 128:
      return horizontal<128, true>(costs, p2, p1, state, sums);
    default:
      return horizontal<0, true>(costs, p2, p1, state, sums);
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(penalties);
HWY_EXPORT(vertical_path);
HWY_EXPORT(vertical_path_pair);
HWY_EXPORT(horizontal_paths);

void penalties(const std::uint8_t* a, const std::uint8_t* b, int count, const Parameters& p,
               std::uint8_t* p2) {
  HWY_DYNAMIC_DISPATCH(penalties)(a, b, count, p, p2);
}
void vertical_path(const std::uint8_t* costs, const std::uint8_t* p2, int p1, std::uint8_t* paths,
                   const PathSums& sums) {
  HWY_DYNAMIC_DISPATCH(vertical_path)(costs, p2, p1, paths, sums);
}
void vertical_path_pair(const std::uint8_t* costs, const std::uint8_t* p2,
                        const std::uint8_t* p2_right, int p1, std::uint8_t* paths,
                        const PathSums& sums) {
  HWY_DYNAMIC_DISPATCH(vertical_path_pair)(costs, p2, p2_right, p1, paths, sums);
}
void horizontal_paths(const std::uint8_t* costs, const std::uint8_t* p2, int p1, bool both,
                      std::uint8_t* state, const PathSums& sums) {
  HWY_DYNAMIC_DISPATCH(horizontal_paths)(costs, p2, p1, both, state, sums);
}

void PathSumsBuffer::create(int width, int disparity_range) {
  const int lanes = lanes_per_pixel(disparity_range), pitch = lanes + kLaneGroup;
  if (sums_.width == width && sums_.range == disparity_range) return;
  bytes_.create(1, kLaneGroup + width * pitch);
  bytes_ = kNoPathSum;
  sums_ = {bytes_[0] + kLaneGroup, pitch, width, disparity_range, lanes};
}

void VerticalPaths::start(int width, const Parameters& p) {
  parameters_ = p;
  // The column behind the row stays 0: the step from it costs nothing.
  paths_.create(width + 1, lanes_per_pixel(p.disparity_range));
  paths_ = 0;
  p2_.resize(static_cast<std::size_t>(width) + kBorder);
  p2_right_.resize(static_cast<std::size_t>(width) + kBorder);
}

void VerticalPaths::next(const cv::Mat1b& guide, int y, const std::uint8_t* costs,
                         const PathSums& sums) {
  const int width = sums.width, p1 = parameters_.sgm_p1;
  const bool is_pair = parameters_.sgm_build == SgmBuild::kSmall;
  if (y > 0) {
    penalties(guide[y], guide[y - 1], width, parameters_, p2_.data());
    if (is_pair) penalties(guide[y], guide[y - 1] + 1, width, parameters_, p2_right_.data());
  }
  if (is_pair) {
    vertical_path_pair(costs, p2_.data(), p2_right_.data(), p1, paths_[0], sums);
  } else {
    vertical_path(costs, p2_.data(), p1, paths_[0], sums);
  }
}

void HorizontalPaths::start(int width, const Parameters& p) {
  parameters_ = p;
  p2_.resize(static_cast<std::size_t>(width) + kBorder);
  state_.resize(std::size_t{2} * static_cast<std::size_t>(lanes_per_pixel(p.disparity_range)));
}

void HorizontalPaths::add(const cv::Mat1b& guide, int y, const std::uint8_t* costs,
                          const PathSums& sums) {
  penalties(guide[y] + 1, guide[y], sums.width - 1, parameters_, p2_.data() + 1);
  horizontal_paths(costs, p2_.data(), parameters_.sgm_p1, parameters_.sgm_build == SgmBuild::kFull,
                   state_.data(), sums);
}

}  // namespace fpga_stereo::simd
#endif
