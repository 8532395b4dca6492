#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <opencv2/core.hpp>
#include <vector>

#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

/// Regions of connected pixels and their areas: a union-find forest over pixel numbers.
class Regions {
 public:
  explicit Regions(std::size_t pixels) : parent_(pixels), area_(pixels, 1) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int root(int pixel) {
    while (parent_[pixel] != pixel) {
      parent_[pixel] = parent_[parent_[pixel]];
      pixel = parent_[pixel];
    }
    return pixel;
  }

  void join(int a, int b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (area_[a] < area_[b]) std::swap(a, b);
    parent_[b] = a;
    area_[a] += area_[b];
  }

  int area(int pixel) { return area_[root(pixel)]; }

 private:
  std::vector<int> parent_, area_;
};

}  // namespace

// A pixel of row y is kept iff its region, as seen in rows 0 .. y + kSpeckleLookAhead, has at least
// speckle_size pixels. Looking at whole rows makes the result depend on the image alone, not on
// when labels are merged.
void speckle(const Parameters& p, cv::Mat1w& disparity) {
  if (p.speckle_size == 0) return;
  const int width = disparity.cols;
  const int height = disparity.rows;
  const int range = p.speckle_range * kDisparityScale;
  const cv::Mat1w in = disparity.clone();
  Regions regions(in.total());

  const auto connected = [&](std::uint16_t a, std::uint16_t b) {
    return a != kNoDisparity && b != kNoDisparity && std::abs(a - b) <= range;
  };
  for (int y = 0; y < height + kSpeckleLookAhead; ++y) {
    for (int x = 0; y < height && x < width; ++x) {
      const int pixel = y * width + x;
      if (x > 0 && connected(in(y, x), in(y, x - 1))) regions.join(pixel, pixel - 1);
      if (y > 0 && connected(in(y, x), in(y - 1, x))) regions.join(pixel, pixel - width);
    }
    const int decided = y - kSpeckleLookAhead;
    for (int x = 0; decided >= 0 && decided < height && x < width; ++x) {
      if (regions.area(decided * width + x) < p.speckle_size) disparity(decided, x) = kNoDisparity;
    }
  }
}

}  // namespace fpga_stereo
