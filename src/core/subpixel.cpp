#include <algorithm>
#include <opencv2/core.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

/// Returns the vertex of the least-squares parabola through five sums at -2 .. 2, in 1/32 px:
/// 7 num / (10 den), rounded half away from zero and clamped to +-1 px. Returns 0 if the parabola
/// does not open upwards.
int vertex(const cv::Vec<std::uint16_t, 5>& c) {
  const int num = 2 * c[0] + c[1] - c[3] - 2 * c[4];
  const int den = 2 * c[0] - c[1] - 2 * c[2] - c[3] + 2 * c[4];
  if (den <= 0) return 0;
  // round(a / b) = floor((2 a + b) / 2 b) for a, b >= 0.
  const int a = kDisparityScale * kSubpixelNumerator * std::abs(num);
  const int b = kSubpixelDenominator * den;
  const int magnitude = (2 * a + b) / (2 * b);
  const int clamped = std::min(magnitude, kDisparityScale);
  return num < 0 ? -clamped : clamped;
}

}  // namespace

void subpixel(const Selection& s, const cv::Mat1b& kept, const Parameters& p, cv::Range rows,
              cv::Mat1w& disparity) {
  disparity.create(kept.size());
  if (rows == cv::Range::all()) rows = {0, disparity.rows};
  const int last = p.disparity_range - 1;

  for (int y = rows.start; y < rows.end; ++y) {
    for (int x = 0; x < disparity.cols; ++x) {
      const int d = s.winner(y, x);
      const bool refine = p.subpixel && d >= 2 && d <= last - 2;
      const int value = d * kDisparityScale + (refine ? vertex(s.around(y, x)) : 0);
      disparity(y, x) =
          kept(y, x) != 0 ? static_cast<std::uint16_t>(std::clamp(value, 0, last * kDisparityScale))
                          : kNoDisparity;
    }
  }
}

}  // namespace fpga_stereo
