#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/simd/match.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/simd/match.hpp"

HWY_BEFORE_NAMESPACE();
namespace fpga_stereo::simd::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void window_sums(const std::int16_t* columns, int radius, const WindowSums& block) {
  using D16 = hn::CappedTag<std::uint16_t, kLaneGroup>;
  constexpr std::size_t kParts = kLaneGroup / hn::MaxLanes(D16());
  const WindowSums sums = block;  // a copy that no store below can change
  const D16 d;
  const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
  const auto* first = reinterpret_cast<const std::uint16_t*>(columns);
  const std::ptrdiff_t window = static_cast<std::ptrdiff_t>(2 * radius + 1) * sums.lanes;
  // Processes all columns for one lane group, then the next, so that the sums stay in registers.
  for (int i = 0; i < sums.lanes; i += kLaneGroup) {
    const std::uint16_t* previous = sums.column(sums.begin - 1) + i;
    const std::uint16_t* entering =
        first + static_cast<std::ptrdiff_t>(sums.begin + radius) * sums.lanes + i;
    std::uint16_t* out = sums.column(sums.begin) + i;
    hn::Vec<D16> sum[kParts];
    for (std::size_t k = 0; k < kParts; ++k) sum[k] = hn::LoadU(d, previous + k * lanes);
    for (int x = sums.begin; x < sums.end; ++x, entering += sums.lanes, out += sums.pitch) {
      for (std::size_t k = 0; k < kParts; ++k) {
        const std::uint16_t* next = entering + k * lanes;
        sum[k] = hn::Add(sum[k], hn::Sub(hn::LoadU(d, next), hn::LoadU(d, next - window)));
        hn::StoreU(sum[k], d, out + k * lanes);
      }
    }
  }
}

}  // namespace fpga_stereo::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace fpga_stereo::simd {
namespace {

constexpr std::uint16_t kNoSum = 0xFFFF;

}  // namespace

HWY_EXPORT(window_sums);

void window_sums(const std::int16_t* columns, int radius, const WindowSums& sums) {
  HWY_DYNAMIC_DISPATCH(window_sums)(columns, radius, sums);
}

void Match::start(const CensusPlanes& left, const CensusPlanes& right, const Parameters& p,
                  int first_row) {
  const int width = left.width, lanes = lanes_per_pixel(p.disparity_range);
  left_ = &left;
  right_ = &right;
  window_ = p.correlation_window_size;
  radius_ = window_ / 2;
  row_ = first_row;
  x_ = 0;

  distances_.create(window_, width * lanes);
  distances_ = 0;
  columns_.create(1, (width + window_) * lanes);
  columns_ = 0;
  column_ = columns_[0] + static_cast<std::ptrdiff_t>(radius_ + 1) * lanes;

  // The ring holds a block and the columns before it that right winners still depend on.
  int rows = 1;
  while (rows < lanes + kLaneGroup + kBlockColumns) rows *= 2;
  const int pitch = lanes + kLaneGroup;
  ring_.create(1, rows * pitch + kLaneGroup);
  ring_ = kNoSum;
  sums_ = {ring_[0] + kLaneGroup, pitch, rows - 1, p.disparity_range, lanes, width, 0, 0};

  for (int y = std::max(0, first_row - radius_); y < first_row + radius_; ++y) enter(y, 0, width);
}

/// Adds columns `begin` .. `end` - 1 of row `y` to the column sums. The same step subtracts the row
/// that leaves the window: it is one window height above, and its distances are stored in the same
/// place.
void Match::enter(int y, int begin, int end) {
  std::uint8_t* distances = distances_[y % window_];
  if (y < left_->height) {
    const HammingRow row{left_->row(y), right_->row(y), left_->pitch,   left_->count,
                         sums_.range,   sums_.lanes,    left_->bits / 2};
    hamming_distances(row, begin, end, distances, column_);
  } else {
    clear_distances(sums_.lanes, begin, end, distances, column_);
  }
}

/// Computes S(-1), from which the sums of a row follow.
void Match::start_sums() {
  const int lanes = sums_.lanes;
  std::uint16_t* sum = sums_.column(-1);
  std::fill_n(sum, lanes, std::uint16_t{0});
  const std::int16_t* column = column_;
  for (int x = 0; x < std::min(radius_, sums_.width); ++x, column += lanes) {
    for (int i = 0; i < lanes; ++i) sum[i] = static_cast<std::uint16_t>(sum[i] + column[i]);
  }
  std::fill_n(sum, lanes - sums_.range, kNoSum);
}

const WindowSums& Match::next() {
  const int width = sums_.width;
  sums_.begin = x_;
  sums_.end = std::min(x_ + kBlockColumns, width);
  const int entered = x_ == 0 ? 0 : std::min(x_ + radius_, width);
  enter(row_ + radius_, entered, std::min(sums_.end + radius_, width));
  if (x_ == 0) start_sums();
  window_sums(column_, radius_, sums_);
  x_ = sums_.end;
  if (x_ == width) {
    x_ = 0;
    ++row_;
  }
  return sums_;
}

}  // namespace fpga_stereo::simd
#endif
