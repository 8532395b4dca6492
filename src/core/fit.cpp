#include <algorithm>
#include <cstdlib>
#include <opencv2/core.hpp>

#include "core/popcount.hpp"
#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

using Five = cv::Vec<int, 5>;  // of dL - 2 .. dL + 2
using FiveRow = std::vector<Five>;

/// Adds `from`, which belongs to a winner smaller by `difference`, to the entries of `to` that
/// belong to the same disparities. At the ends, the outermost entry stands for the one beyond it.
void add_shifted(const Five& from, int difference, Five& to) {
  for (int k = 0; k < 5; ++k) to[k] += from[std::clamp(k + difference, 0, 4)];
}

/// Returns the vertex of the V-shaped curve through c(-1), c(0), c(1), in 1/32 px.
int vertex(int before, int here, int after) {
  const int depth = std::max(before, after) - here;
  if (depth <= 0) return 0;
  const int a = kDisparityScale * std::abs(before - after), b = 2 * depth + kFitDamping;
  const int magnitude = std::min((2 * a + b) / (2 * b), kDisparityScale);
  return before < after ? -magnitude : magnitude;
}

}  // namespace

void fit_subpixel(const cv::Mat& left_bits, const cv::Mat& right_bits, const Selection& s,
                  const cv::Mat1b& kept, const Parameters& p, cv::Range rows,
                  cv::Mat1w& disparity) {
  disparity.create(kept.size());
  if (rows == cv::Range::all()) rows = {0, disparity.rows};
  const int width = kept.cols, height = kept.rows, last = p.disparity_range - 1;

  const auto distances = [&](int x, int y) {  // H(x, y, dL - 2) .. H(x, y, dL + 2)
    const auto* left = left_bits.ptr<std::uint32_t>(y);
    const auto* right = right_bits.ptr<std::uint32_t>(y);
    Five five;
    for (int k = 0; k < 5; ++k) {
      const int d = s.winner(y, x) + k - 2;
      const bool is_seen = d >= 0 && d <= last && x - d >= 0;
      five[k] = is_seen ? static_cast<int>(popcount(left[x] ^ right[x - d])) : kSgmCensusBits / 2;
    }
    return five;
  };
  // Sums along columns, then along rows, over pixels that are kept and whose winners differ by at
  // most 1 from that of the pixel that sums.
  FiveRow columns(width);
  for (int y = rows.start; y < rows.end; ++y) {
    std::fill(columns.begin(), columns.end(), Five::all(0));
    for (int v = std::max(y - kFitRadiusY, 0); v <= std::min(y + kFitRadiusY, height - 1); ++v) {
      for (int x = 0; p.subpixel && x < width; ++x) {
        const int difference = s.winner(y, x) - s.winner(v, x);
        if (kept(y, x) == 0 || kept(v, x) == 0 || std::abs(difference) > 1) continue;
        add_shifted(distances(x, v), difference, columns[x]);
      }
    }
    for (int x = 0; x < width; ++x) {
      const int d = s.winner(y, x);
      int value = d * kDisparityScale;
      if (p.subpixel && d >= 1 && d < last) {
        Five sum = Five::all(0);
        for (int u = std::max(x - kFitRadiusX, 0); u <= std::min(x + kFitRadiusX, width - 1); ++u) {
          const int difference = d - s.winner(y, u);
          if (kept(y, u) != 0 && std::abs(difference) <= 1) {
            add_shifted(columns[u], difference, sum);
          }
        }
        value += vertex(sum[1], sum[2], sum[3]);
      }
      disparity(y, x) = kept(y, x) != 0 ? static_cast<std::uint16_t>(value) : kNoDisparity;
    }
  }
}

}  // namespace fpga_stereo
