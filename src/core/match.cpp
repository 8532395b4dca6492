#include <algorithm>
#include <opencv2/core.hpp>

#include "core/census_window.hpp"
#include "core/popcount.hpp"
#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

/// Computes the Hamming distances of two rows of `count` census values of kWords words each.
template <int kWords>
void hamming_row(const std::uint32_t* left, const std::uint32_t* right, int count,
                 std::uint8_t* out) {
  for (int x = 0; x < count; ++x) {
    std::uint32_t distance = 0;
    for (int word = 0; word < kWords; ++word) {
      distance += popcount(left[x * kWords + word] ^ right[x * kWords + word]);
    }
    out[x] = static_cast<std::uint8_t>(distance);
  }
}

}  // namespace

void Match::start(const cv::Mat& left_bits, const cv::Mat& right_bits, const Parameters& p,
                  int first_row) {
  CV_Assert(left_bits.size() == right_bits.size() && left_bits.type() == right_bits.type());
  left_ = left_bits;
  right_ = right_bits;
  half_ = static_cast<int>(census_neighbours(p).size()) / 2;
  radius_ = p.correlation_window_size / 2;
  row_ = first_row;
  first_summed_ = std::max(0, first_row - radius_);
  hamming_.resize(p.correlation_window_size);
  for (cv::Mat1b& row : hamming_) row.create(p.disparity_range, left_.cols);
  sums_.create(p.disparity_range, left_.cols);
  columns_.create(p.disparity_range, left_.cols);
  columns_ = 0;
  for (int y = first_summed_; y < std::min(first_row + radius_, left_.rows); ++y) {
    cv::Mat1b& entering = hamming_[y % p.correlation_window_size];
    hamming(y, entering);
    cv::add(columns_, entering, columns_, cv::noArray(), CV_16U);
  }
}

void Match::hamming(int y, cv::Mat1b& row) const {
  const int words = left_.channels();
  const auto kernel = words == 1   ? hamming_row<1>
                      : words == 2 ? hamming_row<2>
                      : words == 3 ? hamming_row<3>
                                   : hamming_row<4>;
  const auto* left = left_.ptr<std::uint32_t>(y);
  const auto* right = right_.ptr<std::uint32_t>(y);
  for (int d = 0; d < row.rows; ++d) {
    const int unseen =
        std::min(d, row.cols);  // left pixels whose partner lies outside: half the bits
    std::fill(row[d], row[d] + unseen, static_cast<std::uint8_t>(half_));
    kernel(left + static_cast<std::ptrdiff_t>(unseen) * words, right, row.cols - unseen,
           row[d] + unseen);
  }
}

const cv::Mat1w& Match::next() {
  const int window = static_cast<int>(hamming_.size());
  const int leaving = row_ - radius_ - 1;
  const int entering = row_ + radius_;
  // Both rows share a slot, as they are one window height apart.
  cv::Mat1b& slot = hamming_[entering % window];
  if (leaving >= first_summed_) {
    cv::subtract(columns_, slot, columns_, cv::noArray(), CV_16U);
  }
  if (entering < left_.rows) {
    hamming(entering, slot);
    cv::add(columns_, slot, columns_, cv::noArray(), CV_16U);
  }
  const int width = left_.cols;
  for (int d = 0; d < columns_.rows; ++d) {
    const std::uint16_t* column = columns_[d];
    std::uint16_t* out = sums_[d];
    unsigned sum = 0;
    for (int x = 0; x < std::min(radius_, width); ++x) sum += column[x];
    for (int x = 0; x < width; ++x) {
      if (x + radius_ < width) sum += column[x + radius_];
      if (x > radius_) sum -= column[x - radius_ - 1];
      out[x] = static_cast<std::uint16_t>(sum);
    }
  }
  ++row_;
  return sums_;
}

}  // namespace fpga_stereo
