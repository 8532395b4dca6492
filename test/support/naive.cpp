#include "support/naive.hpp"

#include <cmath>
#include <cstdlib>

namespace fpga_stereo::naive {
namespace {

/// Returns floor(a / b) for b > 0.
std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

bool inside(const cv::Mat& image, int x, int y) {
  return x >= 0 && y >= 0 && x < image.cols && y < image.rows;
}

int tap(const cv::Mat& raw, int x, int y, int channel) {
  if (!inside(raw, x, y)) return 0;
  return raw.ptr<std::uint8_t>(y)[x * raw.channels() + channel];
}

int census_size(const Parameters& p) {
  if (p.stereo_algorithm == StereoAlgorithm::kSgm) return 16;
  const int n = p.census_window_size;
  if (p.census_pattern == CensusPattern::kFull) return n * n - 1;
  const int even = n / 4 * 2 + 1;  // offsets -r .. r that are even, r = n / 2
  return even * even - 1;
}

bool census_bit(const cv::Mat& bits, int x, int y, int k) {
  const auto* words = reinterpret_cast<const std::uint32_t*>(bits.ptr(y)) + x * bits.channels();
  return (words[k / 32] >> (k % 32) & 1) != 0;
}

}  // namespace

cv::Point source(const Mesh& mesh, int x, int y) {
  const int i = x / 8;
  const int j = y / 8;
  const int right = x % 8;
  const int down = y % 8;
  int position[2];
  for (int axis = 0; axis < 2; ++axis) {
    const auto column = [&](int at) {
      return mesh.nodes(j, at)[axis] * (8 - down) + mesh.nodes(j + 1, at)[axis] * down;
    };
    const int displacement = column(i) * (8 - right) + column(i + 1) * right;  // 1/8192 px
    const int at = axis == 0 ? x : y;
    // Half up: floor(v + 1/2) with v in 1/32 px.
    position[axis] = at * 32 + static_cast<int>(floor_div(2 * displacement + 256, 512));
  }
  return {position[0], position[1]};
}

cv::Mat rectify(const cv::Mat& raw, const Mesh& mesh) {
  cv::Mat out(mesh.size, raw.type());
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      const cv::Point s = source(mesh, x, y);
      const int left = static_cast<int>(floor_div(s.x, 32));
      const int top = static_cast<int>(floor_div(s.y, 32));
      const int fx = s.x - 32 * left;
      const int fy = s.y - 32 * top;
      for (int c = 0; c < raw.channels(); ++c) {
        const int sum = tap(raw, left, top, c) * (32 - fx) * (32 - fy) +
                        tap(raw, left + 1, top, c) * fx * (32 - fy) +
                        tap(raw, left, top + 1, c) * (32 - fx) * fy +
                        tap(raw, left + 1, top + 1, c) * fx * fy;
        out.ptr<std::uint8_t>(y)[x * raw.channels() + c] =
            static_cast<std::uint8_t>((sum + 512) / 1024);
      }
    }
  }
  return out;
}

std::vector<int> census_bits(const cv::Mat1b& image, const Parameters& p, int x, int y) {
  std::vector<int> bits;
  const auto compare = [&](int dx, int dy) {
    const bool less = inside(image, x + dx, y + dy) && image(y + dy, x + dx) < image(y, x);
    bits.push_back(less ? 1 : 0);
  };
  if (p.stereo_algorithm == StereoAlgorithm::kSgm) {
    for (const int distance : {1, 3}) {
      for (int dy = -distance; dy <= distance; dy += distance) {
        for (int dx = -distance; dx <= distance; dx += distance) {
          if (dx != 0 || dy != 0) compare(dx, dy);
        }
      }
    }
    return bits;
  }
  const int radius = p.census_window_size / 2;
  for (int dy = -radius; dy <= radius; ++dy) {
    for (int dx = -radius; dx <= radius; ++dx) {
      if (dx == 0 && dy == 0) continue;
      const bool even = dx % 2 == 0 && dy % 2 == 0;
      if (p.census_pattern == CensusPattern::kSparse && !even) continue;
      compare(dx, dy);
    }
  }
  return bits;
}

cv::Mat census(const cv::Mat1b& image, const Parameters& p) {
  const int words = (census_size(p) + 31) / 32;
  cv::Mat packed(image.size(), CV_32SC(words), cv::Scalar::all(0));
  for (int y = 0; y < image.rows; ++y) {
    auto* row = reinterpret_cast<std::uint32_t*>(packed.ptr(y));
    for (int x = 0; x < image.cols; ++x) {
      const std::vector<int> bits = census_bits(image, p, x, y);
      for (int w = 0; w < words; ++w) row[x * words + w] = 0;
      for (std::size_t k = 0; k < bits.size(); ++k) {
        row[x * words + static_cast<int>(k / 32)] |= static_cast<std::uint32_t>(bits[k])
                                                     << (k % 32);
      }
    }
  }
  return packed;
}

int hamming(const cv::Mat& left, const cv::Mat& right, int bits, int x, int y, int d) {
  if (x - d < 0) return bits / 2;
  int count = 0;
  for (int k = 0; k < bits; ++k) {
    count += census_bit(left, x, y, k) != census_bit(right, x - d, y, k) ? 1 : 0;
  }
  return count;
}

Sums match(const cv::Mat& left, const cv::Mat& right, const Parameters& p) {
  const int bits = census_size(p);
  const int radius = p.correlation_window_size / 2;
  Sums costs, sums;
  for (int y = 0; y < left.rows; ++y) {
    costs.emplace_back(p.disparity_range, left.cols);
    for (int d = 0; d < p.disparity_range; ++d) {
      for (int x = 0; x < left.cols; ++x) costs[y](d, x) = hamming(left, right, bits, x, y, d);
    }
  }
  for (int y = 0; y < left.rows; ++y) {
    sums.emplace_back(p.disparity_range, left.cols);
    for (int d = 0; d < p.disparity_range; ++d) {
      for (int x = 0; x < left.cols; ++x) {
        int sum = 0;
        for (int v = y - radius; v <= y + radius; ++v) {
          for (int u = x - radius; u <= x + radius; ++u) {
            if (inside(left, u, v)) sum += costs[v](d, u);
          }
        }
        sums[y](d, x) = sum;
      }
    }
  }
  return sums;
}

Selection select(const Sums& sums) {
  const int height = static_cast<int>(sums.size());
  const int range = sums.front().rows;
  const int width = sums.front().cols;
  Selection out;
  create(out, {width, height});
  for (int y = 0; y < height; ++y) {
    const cv::Mat1i& s = sums[y];
    for (int x = 0; x < width; ++x) {
      int best = 0;
      for (int d = range - 1; d >= 0; --d) {
        if (s(d, x) <= s(best, x) || d == range - 1) best = d;
      }
      int runner_up = -1;
      for (int d = 0; d < range; ++d) {
        if (std::abs(d - best) > 1 && (runner_up < 0 || s(d, x) < runner_up)) {
          runner_up = s(d, x);
        }
      }
      int right_best = -1;
      for (int d = range - 1; d >= 0; --d) {
        if (x + d >= width) continue;
        if (right_best < 0 || s(d, x + d) <= s(right_best, x + right_best)) right_best = d;
      }
      out.winner(y, x) = static_cast<std::uint8_t>(best);
      out.right_winner(y, x) = static_cast<std::uint8_t>(right_best);
      out.winner_sum(y, x) = static_cast<std::uint16_t>(s(best, x));
      out.runner_up_sum(y, x) = static_cast<std::uint16_t>(runner_up);
      for (int i = 0; i < 5; ++i) {
        const int d = best - 2 + i;
        const bool searched = d >= 0 && d < range;
        out.around(y, x)[i] = static_cast<std::uint16_t>(searched ? s(d, x) : 0);
      }
    }
  }
  return out;
}

cv::Mat1b check(const Selection& s, const Parameters& p) {
  const auto n = static_cast<std::int64_t>(std::floor(256 * (1 + p.uniqueness_ratio / 100) + 0.5));
  cv::Mat1b kept(s.winner.size());
  for (int y = 0; y < kept.rows; ++y) {
    for (int x = 0; x < kept.cols; ++x) {
      const int d = s.winner(y, x);
      const bool agree = x - d >= 0 && std::abs(s.right_winner(y, x - d) - d) <= p.disp12MaxDiff;
      const bool unique = 256 * std::int64_t{s.runner_up_sum(y, x)} > n * s.winner_sum(y, x);
      const bool wants_unique = p.uniqueness_check && !p.dense;
      const bool keep = (agree || !p.left_right_check) && (unique || !wants_unique);
      kept(y, x) = keep ? 1 : 0;
    }
  }
  return kept;
}

int parabola_offset(const cv::Vec<std::uint16_t, 5>& c, int numerator, int denominator) {
  const std::int64_t num = 2 * c[0] + c[1] - c[3] - 2 * c[4];
  const std::int64_t den = 2 * c[0] - c[1] - 2 * c[2] - c[3] + 2 * c[4];
  if (den <= 0) return 0;
  const std::int64_t above = 32 * numerator * num;  // offset = above / below, in 1/32 px
  const std::int64_t below = denominator * den;
  if (above > 32 * below) return 32;
  if (above < -32 * below) return -32;
  const std::int64_t size = floor_div(2 * std::abs(above) + below, 2 * below);
  return static_cast<int>(above < 0 ? -size : size);
}

cv::Mat1w subpixel(const Selection& s, const cv::Mat1b& kept, const Parameters& p) {
  const int last = p.disparity_range - 1;
  cv::Mat1w out(kept.size());
  for (int y = 0; y < out.rows; ++y) {
    for (int x = 0; x < out.cols; ++x) {
      const int d = s.winner(y, x);
      int value = 32 * d;
      if (p.subpixel && d >= 2 && d <= last - 2) value += parabola_offset(s.around(y, x));
      if (value < 0) value = 0;
      if (value > 32 * last) value = 32 * last;
      out(y, x) = kept(y, x) != 0 ? static_cast<std::uint16_t>(value) : kNoDisparity;
    }
  }
  return out;
}

}  // namespace fpga_stereo::naive
