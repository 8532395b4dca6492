#include "core/sgm_images.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace fpga_stereo {

void smooth_rows(const cv::Mat1b& image, cv::Range rows, cv::Mat1b& smooth) {
  smooth.create(image.size());
  if (rows == cv::Range::all()) rows = {0, image.rows};
  const int last = image.cols - 1;
  for (int y = rows.start; y < rows.end; ++y) {
    const std::uint8_t* in = image[y];
    for (int x = 0; x <= last; ++x) {
      const int sum = in[std::max(x - 1, 0)] + 2 * in[x] + in[std::min(x + 1, last)];
      smooth(y, x) = static_cast<std::uint8_t>((sum + 2) >> 2);
    }
  }
}

void smooth_binomial(const cv::Mat1b& image, cv::Range rows, cv::Mat1b& smooth) {
  constexpr std::array<int, 5> kWeights{1, 4, 6, 4, 1};
  smooth.create(image.size());
  if (rows == cv::Range::all()) rows = {0, image.rows};
  for (int y = rows.start; y < rows.end; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      int sum = 0;
      for (int j = 0; j < 5; ++j) {
        const std::uint8_t* in = image[std::clamp(y + j - 2, 0, image.rows - 1)];
        for (int i = 0; i < 5; ++i) {
          sum += kWeights[j] * kWeights[i] * in[std::clamp(x + i - 2, 0, image.cols - 1)];
        }
      }
      smooth(y, x) = static_cast<std::uint8_t>((sum + 128) >> 8);
    }
  }
}

}  // namespace fpga_stereo
