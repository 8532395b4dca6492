#include <algorithm>
#include <cstdlib>
#include <opencv2/core.hpp>

#include "core/sgm_images.hpp"
#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

/// Returns the smallest of a path's costs, with the penalty of a step of one disparity:
/// min(row[d], row[d - 1] + P1, row[d + 1] + P1).
int smallest_step(const std::uint8_t* row, int range, int d, int p1) {
  int smallest = row[d];
  if (d > 0) smallest = std::min(smallest, row[d - 1] + p1);
  if (d + 1 < range) smallest = std::min(smallest, row[d + 1] + p1);
  return smallest;
}

}  // namespace

void Aggregate::start(const cv::Mat1b& left, const Parameters& p) {
  smooth_binomial(left, cv::Range::all(), guide_);
  parameters_ = p;
  row_ = 0;
  up_.create(left.cols, p.disparity_range);
  up_ = 0;
  sums_.create(left.cols, p.disparity_range);
}

/// Returns P2 for a step between pixels (x0, y0) and (x1, y1).
int Aggregate::p2(int x0, int y0, int x1, int y1) const {
  const int difference = std::abs(guide_(y0, x0) - guide_(y1, x1));
  if (difference < parameters_.sgm_edge) return parameters_.sgm_p2;
  if (difference < parameters_.sgm_strong_edge) return parameters_.sgm_p2_edge;
  return parameters_.sgm_p2_strong_edge;
}

/// Adds the contribution of the path from `first` to the end of the row, in steps of +1 or -1.
void Aggregate::horizontal_path(const cv::Mat1b& costs, int first, int step) {
  const int range = costs.cols;
  std::vector<std::uint8_t> previous(costs[first], costs[first] + range), path(range);
  for (int d = 0; d < range; ++d) sums_(first, d) += previous[d];
  // M(n - 1), M(n - 2), M(n - 3). Costs are kept relative to M(n - 1), which never decreases.
  int last = 0, second = 0, third = 0;
  for (int x = first + step; x >= 0 && x < costs.rows; x += step) {
    const int jump = third - second + p2(x, row_, x - step, row_);
    int smallest = 255;
    for (int d = 0; d < range; ++d) {
      // Relative to M(n - 2), as `previous` is.
      const int best = std::min(smallest_step(previous.data(), range, d, parameters_.sgm_p1), jump);
      path[d] = static_cast<std::uint8_t>(costs(x, d) + best - (last - second));
      smallest = std::min<int>(smallest, path[d]);
      sums_(x, d) += path[d];
    }
    std::swap(previous, path);
    third = second;
    second = last;
    last += smallest;
  }
}

/// Adds the contribution of the path from above, and in the small build that from the upper right.
void Aggregate::vertical_paths(const cv::Mat1b& costs) {
  const int range = costs.cols, width = costs.rows;
  cv::Mat1b above = up_.clone();
  for (int x = 0; x < width; ++x) {
    int smallest = 255;
    for (int d = 0; d < range; ++d) {
      const auto step_from = [&](int from) {
        if (row_ == 0 || from >= width) return 0;
        return std::min(smallest_step(above[from], range, d, parameters_.sgm_p1),
                        p2(x, row_, from, row_ - 1));
      };
      int best = step_from(x);
      if (parameters_.sgm_build == SgmBuild::kSmall) best = (best + step_from(x + 1)) >> 1;
      up_(x, d) = static_cast<std::uint8_t>(costs(x, d) + best);
      smallest = std::min<int>(smallest, up_(x, d));
      sums_(x, d) += up_(x, d);
    }
    for (int d = 0; d < range; ++d) {
      up_(x, d) = static_cast<std::uint8_t>(std::min(up_(x, d) - smallest, kSgmMaxPath));
    }
  }
}

const cv::Mat1w& Aggregate::next(const cv::Mat1b& costs) {
  cv::Mat1b by_pixel;
  cv::transpose(costs, by_pixel);
  sums_ = 0;
  horizontal_path(by_pixel, 0, 1);
  if (parameters_.sgm_build == SgmBuild::kFull) horizontal_path(by_pixel, by_pixel.rows - 1, -1);
  vertical_paths(by_pixel);
  ++row_;
  cv::transpose(sums_, by_disparity_);
  return by_disparity_;
}

}  // namespace fpga_stereo
