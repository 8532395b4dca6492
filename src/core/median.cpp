#include <algorithm>
#include <array>
#include <cstdlib>
#include <opencv2/core.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {

void masked_median(const cv::Mat1b& left, const cv::Mat1w& in, const Parameters& p, cv::Range rows,
                   cv::Mat1w& out) {
  out.create(in.size());
  if (rows == cv::Range::all()) rows = {0, in.rows};
  const cv::Rect image({0, 0}, in.size());
  std::vector<std::uint16_t> values;
  for (int y = rows.start; y < rows.end; ++y) {
    for (int x = 0; x < in.cols; ++x) {
      values.clear();
      for (int dy = -kMaskedMedianRadiusY; dy <= kMaskedMedianRadiusY; dy += kMaskedMedianStepY) {
        for (int dx = -kMaskedMedianRadiusX; dx <= kMaskedMedianRadiusX; dx += kMaskedMedianStepX) {
          const cv::Point at(x + dx, y + dy);
          if (!image.contains(at)) continue;
          if (std::abs(left(at) - left(y, x)) <= p.median_difference) values.push_back(in(at));
        }
      }
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
      std::nth_element(values.begin(), middle, values.end());
      out(y, x) = *middle;
    }
  }
}

void median(const cv::Mat1w& in, cv::Range rows, cv::Mat1w& out) {
  constexpr int kSide = 2 * kMedianRadius + 1;
  out.create(in.size());
  if (rows == cv::Range::all()) rows = {0, in.rows};
  std::array<std::uint16_t, static_cast<std::size_t>(kSide * kSide)> values{};
  for (int y = rows.start; y < rows.end; ++y) {
    for (int x = 0; x < in.cols; ++x) {
      std::size_t n = 0;
      for (int dy = -kMedianRadius; dy <= kMedianRadius; ++dy) {
        const std::uint16_t* row = in[std::clamp(y + dy, 0, in.rows - 1)];
        for (int dx = -kMedianRadius; dx <= kMedianRadius; ++dx) {
          values[n++] = row[std::clamp(x + dx, 0, in.cols - 1)];
        }
      }
      std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
      out(y, x) = values[values.size() / 2];
    }
  }
}

}  // namespace fpga_stereo
