// Scalar rectification of pixels of a row. SIMD uses it at the borders of the raw image.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "fpga_stereo/core/mesh.hpp"

namespace fpga_stereo {

/// Rectifies the pixels x0 .. x1 - 1 of a row: interpolates bilinearly over 2 x 2 raw pixels,
/// rounded half up. Taps outside the raw image are 0.
template <int kChannels>
void rectify_pixels(const cv::Mat& raw, const MeshRow& mesh, int x0, int x1, std::uint8_t* out) {
  constexpr int kOne = kSourceScale;  // sum of the weights of two neighbours
  for (int x = x0; x < x1; ++x) {
    const cv::Point source = mesh.source(x);
    const int left = source.x >> kSourceShift;
    const int top = source.y >> kSourceShift;
    const int wx = source.x & (kOne - 1);
    const int wy = source.y & (kOne - 1);
    for (int channel = 0; channel < kChannels; ++channel) {
      const auto tap = [&](int tap_x, int tap_y) -> int {
        const bool inside = tap_x >= 0 && tap_x < raw.cols && tap_y >= 0 && tap_y < raw.rows;
        return inside ? raw.ptr(tap_y)[tap_x * kChannels + channel] : 0;
      };
      const int sum = (kOne - wy) * ((kOne - wx) * tap(left, top) + wx * tap(left + 1, top)) +
                      wy * ((kOne - wx) * tap(left, top + 1) + wx * tap(left + 1, top + 1));
      out[x * kChannels + channel] =
          static_cast<std::uint8_t>((sum + kOne * kOne / 2) >> (2 * kSourceShift));
    }
  }
}

}  // namespace fpga_stereo
