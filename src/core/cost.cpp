#include <algorithm>
#include <cstdlib>
#include <limits>
#include <opencv2/core.hpp>

#include "core/popcount.hpp"
#include "core/sgm_images.hpp"
#include "core/stages.hpp"

namespace fpga_stereo {

void Cost::start(const cv::Mat1b& left, const cv::Mat1b& right, const cv::Mat& left_bits,
                 const cv::Mat& right_bits, const Parameters& p, int first_row) {
  CV_Assert(left_bits.type() == CV_32SC1 && right_bits.type() == CV_32SC1);
  left_bits_ = left_bits;
  right_bits_ = right_bits;
  smooth_rows(left, cv::Range::all(), left_);
  smooth_rows(right, cv::Range::all(), right_);
  parameters_ = p;
  row_ = first_row;
  for (cv::Mat1w& row : pixel_costs_) row.create(p.disparity_range, left.cols);
  costs_.create(p.disparity_range, left.cols);
  for (int y = first_row - 1; y <= first_row; ++y) pixel_cost(y);
}

/// Computes p(x, y, d) of row y, which is 0 outside the image.
void Cost::pixel_cost(int y) {
  cv::Mat1w& row = pixel_costs_[(y + 3) % 3];
  if (y < 0 || y >= left_.rows) {
    row = 0;
    return;
  }
  const auto* left_bits = left_bits_.ptr<std::uint32_t>(y);
  const auto* right_bits = right_bits_.ptr<std::uint32_t>(y);
  const std::uint8_t *left = left_[y], *right = right_[y];
  for (int d = 0; d < row.rows; ++d) {
    std::uint16_t* out = row[d];
    const int unseen = std::min(d, row.cols);  // left pixels whose partner lies outside
    std::fill(out, out + unseen, static_cast<std::uint16_t>(parameters_.cost_outside));
    for (int x = unseen; x < row.cols; ++x) {
      const int difference =
          std::min(std::abs(left[x] - right[x - d]), parameters_.cost_difference_limit);
      out[x] = static_cast<std::uint16_t>(popcount(left_bits[x] ^ right_bits[x - d]) +
                                          (difference >> parameters_.cost_difference_shift));
    }
  }
}

const cv::Mat1b& Cost::next() {
  pixel_cost(row_ + 1);
  ++row_;
  const auto& p = pixel_costs_;
  const int range = costs_.rows, width = costs_.cols;
  std::vector<int> smallest(width, std::numeric_limits<int>::max());
  for (int d = 0; d < range; ++d) {
    for (int x = 0; x < width; ++x) {
      smallest[x] = std::min(smallest[x], p[0](d, x) + p[1](d, x) + p[2](d, x));
    }
  }
  for (int d = 0; d < range; ++d) {
    for (int x = 0; x < width; ++x) {
      const int excess = p[0](d, x) + p[1](d, x) + p[2](d, x) - smallest[x];
      costs_(d, x) =
          static_cast<std::uint8_t>(std::min(excess >> parameters_.cost_shift, kSgmMaxCost));
    }
  }
  return costs_;
}

}  // namespace fpga_stereo
