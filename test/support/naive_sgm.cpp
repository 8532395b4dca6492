// Semi-global matching, with path costs as the definition writes them: absolute, not relative to
// their minimum.
#include <algorithm>
#include <cstdlib>

#include "support/naive.hpp"

namespace fpga_stereo::naive {
namespace {

constexpr int kBits = 16;

bool inside(const cv::Mat& image, int x, int y) {
  return x >= 0 && y >= 0 && x < image.cols && y < image.rows;
}

/// Returns the grey value at (x, y), borders replicated.
int grey(const cv::Mat1b& image, int x, int y) {
  return image(std::clamp(y, 0, image.rows - 1), std::clamp(x, 0, image.cols - 1));
}

/// Returns A(x, y).
int smooth_along_row(const cv::Mat1b& image, int x, int y) {
  return (grey(image, x - 1, y) + 2 * grey(image, x, y) + grey(image, x + 1, y) + 2) / 4;
}

/// Returns G(x, y).
int smooth(const cv::Mat1b& image, int x, int y) {
  const int weights[] = {1, 4, 6, 4, 1};
  int sum = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      sum += weights[dx + 2] * weights[dy + 2] * grey(image, x + dx, y + dy);
    }
  }
  return (sum + 128) / 256;
}

int distance(const cv::Mat& left, int x, const cv::Mat& right, int right_x, int y) {
  int count = 0;
  for (int k = 0; k < kBits; ++k) {
    const int l = left.at<int>(y, x) >> k & 1;
    const int r = right.at<int>(y, right_x) >> k & 1;
    if (l != r) ++count;
  }
  return count;
}

/// Returns P2 between two neighbouring pixels.
int penalty(const cv::Mat1b& image, cv::Point a, cv::Point b, const Parameters& p) {
  const int difference = std::abs(smooth(image, a.x, a.y) - smooth(image, b.x, b.y));
  if (difference < p.sgm_edge) return p.sgm_p2;
  if (difference < p.sgm_strong_edge) return p.sgm_p2_edge;
  return p.sgm_p2_strong_edge;
}

/// Returns the smallest of v(d), v(d-1) + p1 and v(d+1) + p1 for column x of `v`.
int cheapest_small_step(const cv::Mat1i& v, int d, int x, int p1) {
  int least = v(d, x);
  if (d > 0) least = std::min(least, v(d - 1, x) + p1);
  if (d < v.rows - 1) least = std::min(least, v(d + 1, x) + p1);
  return least;
}

cv::Mat1i mirrored(const cv::Mat1i& row) {
  cv::Mat1i out(row.size());
  for (int x = 0; x < row.cols; ++x) row.col(row.cols - 1 - x).copyTo(out.col(x));
  return out;
}

/// Returns L of the paths from above, by row.
Sums paths_from_above(const cv::Mat1b& left, const Sums& costs, const Parameters& p) {
  Sums paths, capped;  // L, and N, which is L above its smallest, at most 15
  for (int y = 0; y < left.rows; ++y) {
    paths.push_back(costs[y].clone());
    const auto step = [&](int x, int from, int d) {
      if (y == 0 || from >= left.cols) return 0;
      const int p2 = penalty(left, {x, y}, {from, y - 1}, p);
      return std::min(cheapest_small_step(capped[y - 1], d, from, p.sgm_p1), p2);
    };
    capped.emplace_back(costs[y].size());
    for (int x = 0; x < left.cols; ++x) {
      int least = 1000;
      for (int d = 0; d < p.disparity_range; ++d) {
        paths[y](d, x) += p.sgm_build == SgmBuild::kFull ? step(x, x, d)
                                                         : (step(x, x, d) + step(x, x + 1, d)) / 2;
        least = std::min(least, paths[y](d, x));
      }
      for (int d = 0; d < p.disparity_range; ++d) {
        capped[y](d, x) = std::min(paths[y](d, x) - least, 15);
      }
    }
  }
  return paths;
}

/// Returns h_q(k) of pixel q = (x, y).
int fit_distance(const cv::Mat& left_bits, const cv::Mat& right_bits, int winner, int k,
                 const Parameters& p, int x, int y) {
  const int d = winner + std::clamp(k, -2, 2);
  if (d < 0 || d >= p.disparity_range || x - d < 0) return 8;
  return distance(left_bits, x, right_bits, x - d, y);
}

}  // namespace

Sums cost(const cv::Mat1b& left, const cv::Mat1b& right, const cv::Mat& left_bits,
          const cv::Mat& right_bits, const Parameters& p) {
  const auto pixel_cost = [&](int x, int y, int d) {
    if (y < 0 || y >= left.rows) return 0;
    if (x - d < 0) return p.cost_outside;
    const int difference =
        std::abs(smooth_along_row(left, x, y) - smooth_along_row(right, x - d, y));
    return distance(left_bits, x, right_bits, x - d, y) +
           (std::min(difference, p.cost_difference_limit) >> p.cost_difference_shift);
  };
  Sums costs;
  for (int y = 0; y < left.rows; ++y) {
    costs.emplace_back(p.disparity_range, left.cols);
    for (int x = 0; x < left.cols; ++x) {
      const auto sum = [&](int d) {
        return pixel_cost(x, y - 1, d) + pixel_cost(x, y, d) + pixel_cost(x, y + 1, d);
      };
      int least = sum(0);
      for (int d = 1; d < p.disparity_range; ++d) least = std::min(least, sum(d));
      for (int d = 0; d < p.disparity_range; ++d) {
        costs[y](d, x) = std::min((sum(d) - least) >> p.cost_shift, 3);
      }
    }
  }
  return costs;
}

Path path_from_left(const cv::Mat1i& costs, const std::vector<int>& p2, int p1) {
  Path path;
  path.costs = costs.clone();
  for (int n = 0; n < costs.cols; ++n) {
    for (int d = 0; d < costs.rows && n > 0; ++d) {
      const int least_before = n - 3 > 0 ? path.minima[n - 3] : 0;
      path.costs(d, n) +=
          std::min(cheapest_small_step(path.costs, d, n - 1, p1), least_before + p2[n]);
    }
    double least = 0;
    cv::minMaxLoc(path.costs.col(n), &least);
    path.minima.push_back(n > 0 ? static_cast<int>(least) : 0);
  }
  return path;
}

Sums aggregate(const cv::Mat1b& left, const Sums& costs, const Parameters& p) {
  Sums sums = paths_from_above(left, costs, p);
  for (int y = 0; y < left.rows; ++y) {
    std::vector<int> from_left(left.cols), from_right(left.cols);
    for (int n = 1; n < left.cols; ++n) {
      const int x = left.cols - 1 - n;  // of pixel n of the path from the right
      from_left[n] = penalty(left, {n, y}, {n - 1, y}, p);
      from_right[n] = penalty(left, {x, y}, {x + 1, y}, p);
    }
    const auto contribution = [&](const cv::Mat1i& row, const std::vector<int>& p2) {
      const Path path = path_from_left(row, p2, p.sgm_p1);
      cv::Mat1i out = path.costs.clone();
      for (int n = 1; n < row.cols; ++n) out.col(n) -= path.minima[n - 1];
      return out;
    };
    sums[y] += contribution(costs[y], from_left);
    if (p.sgm_build == SgmBuild::kSmall) continue;
    sums[y] += mirrored(contribution(mirrored(costs[y]), from_right));
  }
  return sums;
}

cv::Mat1w fit_subpixel(const cv::Mat& left_bits, const cv::Mat& right_bits, const Selection& s,
                       const cv::Mat1b& kept, const Parameters& p) {
  const auto is_summed = [&](cv::Point at, cv::Point q) {
    return inside(kept, q.x, q.y) && kept(q) != 0 && std::abs(s.winner(at) - s.winner(q)) <= 1;
  };
  const auto column_sum = [&](cv::Point at, int k) {
    int sum = 0;
    for (int j = -5; j <= 5; ++j) {
      const cv::Point q(at.x, at.y + j);
      if (!is_summed(at, q)) continue;
      const int shift = s.winner(at) - s.winner(q);
      sum += fit_distance(left_bits, right_bits, s.winner(q), shift + k, p, q.x, q.y);
    }
    return sum;
  };
  const auto window_sum = [&](cv::Point at, int k) {
    int sum = 0;
    for (int i = -4; i <= 4; ++i) {
      const cv::Point q(at.x + i, at.y);
      if (is_summed(at, q)) sum += column_sum(q, s.winner(at) - s.winner(q) + k);
    }
    return sum;
  };
  cv::Mat1w out(kept.size(), kNoDisparity);
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      if (kept(y, x) == 0) continue;
      const int winner = s.winner(y, x);
      const int before = window_sum({x, y}, -1);
      const int after = window_sum({x, y}, 1);
      const int depth = std::max(before, after) - window_sum({x, y}, 0);
      int offset = 0;
      if (p.subpixel && depth > 0 && winner > 0 && winner < p.disparity_range - 1) {
        const int below = 2 * depth + 64;
        const int size = (2 * 32 * std::abs(before - after) + below) / (2 * below);
        offset = std::min(size, 32) * (before < after ? -1 : 1);
      }
      out(y, x) = static_cast<std::uint16_t>(32 * winner + offset);
    }
  }
  return out;
}

cv::Mat1w fill(const cv::Mat1w& disparity) {
  cv::Mat1w out = disparity.clone();
  for (int y = 0; y < out.rows; ++y) {
    const auto nearest = [&](int x, int step) {
      while (x >= 0 && x < out.cols && disparity(y, x) == kNoDisparity) x += step;
      return x >= 0 && x < out.cols ? disparity(y, x) : kNoDisparity;
    };
    for (int x = 0; x < out.cols; ++x) {
      // kNoDisparity is the largest value, so the smaller one is a disparity if there is any.
      if (disparity(y, x) == kNoDisparity) out(y, x) = std::min(nearest(x, -1), nearest(x, 1));
    }
  }
  return out;
}

cv::Mat1w masked_median(const cv::Mat1b& left, const cv::Mat1w& disparity, const Parameters& p) {
  cv::Mat1w out(disparity.size());
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      std::vector<std::uint16_t> values;
      for (const int dy : {-4, -2, 0, 2, 4}) {
        for (const int dx : {-6, 0, 6}) {
          if (!inside(left, x + dx, y + dy)) continue;
          if (std::abs(left(y + dy, x + dx) - left(y, x)) > p.median_difference) continue;
          values.push_back(disparity(y + dy, x + dx));
        }
      }
      std::sort(values.begin(), values.end());
      out(y, x) = values[(values.size() - 1) / 2];
    }
  }
  return out;
}

cv::Mat1w median(const cv::Mat1w& disparity) {
  cv::Mat1w out(disparity.size());
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      std::vector<std::uint16_t> values;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
          values.push_back(
              disparity(std::clamp(y + dy, 0, out.rows - 1), std::clamp(x + dx, 0, out.cols - 1)));
        }
      }
      std::sort(values.begin(), values.end());
      out(y, x) = values[12];
    }
  }
  return out;
}

}  // namespace fpga_stereo::naive
