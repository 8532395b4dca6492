#include "core/simd/row_matcher.hpp"

#include <algorithm>
#include <chrono>

namespace fpga_stereo::simd {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kColumns = 32;  // that are summed and selected from at a time: they stay in L1
constexpr std::uint16_t kNoSum = 0xFFFF;

}  // namespace

void CensusPlanes::create(cv::Size size, int count, int padded) {
  planes = count;
  first = padded;
  pitch = padded + size.width + kBorder;
  bytes.create(size.height, static_cast<int>(pitch) * count);
}

void RowMatcher::start(const CensusPlanes& left, const CensusPlanes& right, int width,
                       const Parameters& p, int census_bits, int first_row) {
  left_ = &left;
  right_ = &right;
  width_ = width;
  height_ = left.bytes.rows;
  range_ = p.disparity_range;
  padded_ = padded_range(range_);
  half_ = census_bits / 2;
  window_ = p.correlation_window_size;
  radius_ = window_ / 2;
  row_ = first_row;
  entered_ = 0;

  slots_.create(window_, width * padded_);
  slots_ = 0;
  columns_.create(1, (width + window_) * padded_);  // columns of zeros on both sides
  columns_ = 0;
  column_ = columns_[0] + static_cast<std::ptrdiff_t>(radius_ + 1) * padded_;

  int rows = 1;
  while (rows < padded_ + kLaneGroup + kColumns) rows *= 2;
  const int pitch = padded_ + kLaneGroup;
  ring_.create(1, rows * pitch + kLaneGroup);
  ring_ = kNoSum;
  sums_ = {ring_[0] + kLaneGroup, pitch, rows - 1, range_, padded_};

  words_.create(7, width + kBorder);
  bytes_.create(2, padded_ + width + kBorder);
  words_ = 0;
  bytes_ = 0;
  selected_ = {bytes_[0] + padded_,
               bytes_[1] + padded_,
               words_[0],
               words_[1],
               {words_[2], words_[3], words_[4], words_[5], words_[6]}};

  for (int y = std::max(0, first_row - radius_); y < first_row + radius_; ++y) {
    entered_ = 0;
    enter(y, width);
  }
}

void RowMatcher::enter(int y, int end) {
  // The row that leaves has the same slot: they are one window apart.
  std::uint8_t* slot = slots_[y % window_];
  if (y < height_) {
    const HammingRow row{left_->row(y), right_->row(y), left_->pitch, left_->planes,
                         range_,        padded_,        half_};
    hamming(row, entered_, end, slot, column_);
  } else {
    leave(padded_, entered_, end, slot, column_);
  }
  entered_ = end;
}

/// S(-1), from which the others follow.
void RowMatcher::begin_sums() {
  std::uint16_t* sum = sums_.row(-1);
  std::fill_n(sum, padded_, std::uint16_t{0});
  const std::int16_t* column = column_;
  for (int x = 0; x < std::min(radius_, width_); ++x, column += padded_) {
    for (int i = 0; i < padded_; ++i) sum[i] = static_cast<std::uint16_t>(sum[i] + column[i]);
  }
  std::fill_n(sum, padded_ - range_, kNoSum);
}

/// Right pixels follow as soon as all their partners are there.
int RowMatcher::select_columns(int x0, int x1, int next_right) {
  select_left(sums_, x0, x1, selected_);
  while (next_right < width_ && (next_right + kLaneGroup + range_ - 1 <= x1 || x1 == width_)) {
    select_right(sums_, next_right, width_, selected_.right_winner);
    next_right += kLaneGroup;
  }
  return next_right;
}

const SelectedRow& RowMatcher::next(double* select_ms) {
  entered_ = 0;
  int next_right = 0;
  for (int x0 = 0; x0 < width_; x0 += kColumns) {
    const int x1 = std::min(x0 + kColumns, width_);
    enter(row_ + radius_, std::min(x1 + radius_, width_));
    if (x0 == 0) begin_sums();
    box(column_, radius_, x0, x1, sums_);
    if (select_ms == nullptr) {
      next_right = select_columns(x0, x1, next_right);
    } else {
      const auto start = Clock::now();
      next_right = select_columns(x0, x1, next_right);
      *select_ms += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    }
  }
  ++row_;
  return selected_;
}

}  // namespace fpga_stereo::simd
