#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/cost.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/cost.hpp"
#include "core/simd/lanes-inl.hpp"
#include "fpga_stereo/core/spec.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

// In what follows, kLanes > 0 fixes the lanes per pixel at compile time.

/// Computes columns `begin` .. `end` - 1. With kEdge, some lanes may have no right pixel.
template <int kLanes, bool kEdge>
HWY_INLINE void pixel_cost_columns(const CostRow row, int begin, int end, std::uint8_t* out) {
  const Bytes d;
  const int lanes = kLanes > 0 ? kLanes : row.lanes, step = static_cast<int>(hn::Lanes(d));
  const auto number = hn::Iota(d, std::uint8_t{0});
  const auto limit = hn::Set(d, static_cast<std::uint8_t>(row.difference_limit));
  const auto outside = hn::Set(d, static_cast<std::uint8_t>(row.outside));
  const std::ptrdiff_t pitch = row.plane_pitch;
  out += static_cast<std::ptrdiff_t>(begin) * lanes;
  for (int x = begin; x < end; ++x, out += lanes) {
    const auto left0 = hn::Set(d, row.left[x]), left1 = hn::Set(d, row.left[pitch + x]);
    const auto grey = hn::Set(d, row.left[2 * pitch + x]);
    const std::uint8_t* const right = row.right + x - (lanes - 1);
    for (int i = 0; i < lanes; i += step) {
      const auto bits0 = hn::PopulationCount(hn::Xor(left0, hn::LoadU(d, right + i)));
      const auto bits1 = hn::PopulationCount(hn::Xor(left1, hn::LoadU(d, right + pitch + i)));
      const auto other = hn::LoadU(d, right + 2 * pitch + i);
      const auto difference = hn::Min(absolute_difference(grey, other), limit);
      auto cost =
          hn::Add(hn::Add(bits0, bits1), hn::ShiftRightSame(difference, row.difference_shift));
      if constexpr (kEdge) {
        const int unseen = std::clamp(lanes - 1 - x - i, 0, step);
        const auto is_unseen = hn::Lt(number, hn::Set(d, static_cast<std::uint8_t>(unseen)));
        cost = hn::IfThenElse(is_unseen, outside, cost);
      }
      hn::StoreU(cost, d, out + i);
    }
  }
}

void pixel_costs(const CostRow& row, std::uint8_t* out) {
  const int inside = std::min(row.lanes - 1, row.width);
  pixel_cost_columns<0, true>(row, 0, inside, out);
  if (row.lanes == 64) return pixel_cost_columns<64, false>(row, inside, row.width, out);
  pixel_cost_columns<0, false>(row, inside, row.width, out);
}

/// Replaces the lanes that have no disparity.
HWY_INLINE VBytes replace_unused(VBytes v, int i, int unused, std::uint8_t value) {
  const Bytes d;
  if (i >= unused) return v;
  const int count = std::min(unused - i, static_cast<int>(hn::Lanes(d)));
  const auto is_unused =
      hn::Lt(hn::Iota(d, std::uint8_t{0}), hn::Set(d, static_cast<std::uint8_t>(count)));
  return hn::IfThenElse(is_unused, hn::Set(d, value), v);
}

/// With kLanes > 0, every lane must have a disparity.
template <int kLanes>
HWY_INLINE void matching_costs_of(const CostRow row, const std::uint8_t* above,
                                  const std::uint8_t* here, const std::uint8_t* below,
                                  std::uint8_t* costs) {
  constexpr int kPixels = 16;  // at a time: their smallest sums are found together
  const Bytes d;
  const int lanes = kLanes > 0 ? kLanes : row.lanes, step = static_cast<int>(hn::Lanes(d));
  const int unused = kLanes > 0 ? 0 : lanes - row.range;
  const auto max_cost = hn::Set(d, static_cast<std::uint8_t>(kSgmMaxCost));
  HWY_ALIGN std::uint8_t blocks[16 * kPixels] = {};
  HWY_ALIGN std::uint8_t smallest[kPixels];
  for (int x = 0; x < row.width; x += kPixels) {
    const int count = std::min(kPixels, row.width - x);
    std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) * lanes;
    for (int k = 0; k < count; ++k, at += lanes) {
      auto min = hn::Set(d, std::uint8_t{0xFF});
      for (int i = 0; i < lanes; i += step) {
        auto sum = hn::Add(hn::Add(hn::LoadU(d, above + at + i), hn::LoadU(d, here + at + i)),
                           hn::LoadU(d, below + at + i));
        sum = replace_unused(sum, i, unused, 0xFF);
        hn::StoreU(sum, d, costs + at + i);
        min = hn::Min(min, sum);
      }
      hn::StoreU(smallest_block(min), Block8(), blocks + std::ptrdiff_t{16} * k);
    }
    hn::StoreU(smallest_of_blocks(blocks), Block8(), smallest);
    std::uint8_t* out = costs + static_cast<std::ptrdiff_t>(x) * lanes;
    for (int k = 0; k < count; ++k, out += lanes) {
      const auto min = hn::Set(d, smallest[k]);
      for (int i = 0; i < lanes; i += step) {
        const auto excess = hn::ShiftRightSame(hn::Sub(hn::LoadU(d, out + i), min), row.shift);
        hn::StoreU(replace_unused(hn::Min(excess, max_cost), i, unused, kNoCost), d, out + i);
      }
    }
  }
}

void matching_costs(const CostRow& row, const std::uint8_t* above, const std::uint8_t* here,
                    const std::uint8_t* below, std::uint8_t* costs) {
  if (row.lanes == 64 && row.range == 64) {
    return matching_costs_of<64>(row, above, here, below, costs);
  }
  matching_costs_of<0>(row, above, here, below, costs);
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {

HWY_EXPORT(pixel_costs);
HWY_EXPORT(matching_costs);

void pixel_costs(const CostRow& row, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(pixel_costs)(row, out);
}
void matching_costs(const CostRow& row, const std::uint8_t* above, const std::uint8_t* here,
                    const std::uint8_t* below, std::uint8_t* costs) {
  HWY_DYNAMIC_DISPATCH(matching_costs)(row, above, here, below, costs);
}

void Cost::start(const CensusPlanes& left, const CensusPlanes& right, const Parameters& p,
                 int first_row) {
  left_ = &left;
  right_ = &right;
  parameters_ = p;
  lanes_ = lanes_per_pixel(p.disparity_range);
  pixel_costs_.create(3, left.width * lanes_);
  row_ = first_row - 2;
  for (int i = 0; i < 2; ++i) next(nullptr);
}

void Cost::next(std::uint8_t* costs) {
  const int entering = row_ + 1;
  const CostRow row{entering >= 0 && entering < left_->height ? left_->row(entering) : nullptr,
                    entering >= 0 && entering < left_->height ? right_->row(entering) : nullptr,
                    left_->pitch,
                    left_->width,
                    parameters_.disparity_range,
                    lanes_,
                    parameters_.cost_difference_limit,
                    parameters_.cost_difference_shift,
                    parameters_.cost_outside,
                    parameters_.cost_shift};
  if (row.left != nullptr) {
    pixel_costs(row, slot(entering));
  } else {
    std::fill_n(slot(entering), row.width * row.lanes, std::uint8_t{0});
  }
  if (costs != nullptr) {
    matching_costs(row, slot(row_ - 1), slot(row_), slot(entering), costs);
  }
  ++row_;
}

}  // namespace fpga_stereo::simd
#endif
