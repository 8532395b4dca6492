// Compares fs_speckle with speckle().
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "SpeckleSmall.h"
#include "SpeckleVga.h"
#include "SpeckleWide.h"
#include "core/stages.hpp"
#include "raster.hpp"
#include "rtl/configuration.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

// kNear and kFar are connected only at a speckle_range of 31, the largest in these tests.
constexpr int kNear = 40 * kDisparityScale;
constexpr int kFar = 60 * kDisparityScale;
constexpr int kNone = kNoDisparity;

Parameters speckle_parameters(int size, int range) {
  Parameters p = window_parameters();
  p.speckle_size = size;
  p.speckle_range = range;
  return p;
}

/// Sends each image through the model as one frame and compares the filtered disparities.
template <class Model>
RasterResult compare(const std::vector<cv::Mat1w>& images, const Parameters& p, Raster raster) {
  raster.width = images[0].cols;
  raster.height = images[0].rows;
  const auto frames = static_cast<int>(images.size());
  std::vector<cv::Mat1w> expected, actual;
  for (const cv::Mat1w& image : images) {
    expected.push_back(image.clone());
    speckle(p, expected.back());
    actual.emplace_back(image.size(), std::uint16_t{0});
  }
  Model model;
  model.width_i = raster.width;
  model.height_i = raster.height;
  set_config(model, p);
  const RasterResult result = run_raster(
      model, raster, frames,
      [&](int frame, int x, int y) { model.disparity_i = images[frame](y, x); },
      [&](std::mt19937& random) { model.disparity_i = random() % 2 != 0 ? kNear : kNone; },
      [&](int frame, int x, int y) { actual[frame](y, x) = model.disparity_o; });
  for (int frame = 0; frame < frames; ++frame) {
    EXPECT_TRUE(same("speckle", expected[frame], actual[frame],
                     {p, raster.seed, "frame " + std::to_string(frame)}));
  }
  return result;
}

/// Returns an image of the values value(x, y).
cv::Mat1w paint(cv::Size size, const std::function<int(int x, int y)>& value) {
  cv::Mat1w image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(y, x) = static_cast<std::uint16_t>(value(x, y));
  }
  return image;
}

/// Returns random disparities out of 0, step .. levels * step; `invalid_share` of them are invalid.
cv::Mat1w noise(cv::Size size, int levels, int step, double invalid_share, unsigned seed) {
  std::mt19937 random(seed);
  return paint(size, [&](int, int) {
    if (std::uniform_real_distribution<>()(random) < invalid_share) return kNone;
    return std::uniform_int_distribution<>(0, levels)(random) * step;
  });
}

/// Returns noise of many kinds. Regions are most ragged with one level and 40 % invalid pixels.
std::vector<cv::Mat1w> noise_images(cv::Size size, unsigned seed) {
  std::vector<cv::Mat1w> images;
  for (const double invalid : {0.0, 0.1, 0.35, 0.41, 0.6, 0.95}) {
    images.push_back(noise(size, 0, 0, invalid, ++seed));
    images.push_back(noise(size, 2, 20, invalid, ++seed));
    images.push_back(noise(size, 63, kDisparityScale, invalid, ++seed));
  }
  return images;
}

/// Returns a spiral path, 1 px wide and 1 px apart, that turns right wherever it would meet itself.
cv::Mat1b spiral(cv::Size size) {
  cv::Mat1b path(size, std::uint8_t{0});
  const cv::Rect all({0, 0}, size);
  cv::Point at(0, 0), step(1, 0);
  const auto blocked = [&](cv::Point to) {
    const cv::Point beyond = to + step;
    return !all.contains(to) || path(to) != 0 || (all.contains(beyond) && path(beyond) != 0);
  };
  for (int turns = 0; turns < 2;) {
    path(at) = 1;
    if (blocked(at + step)) {
      step = cv::Point(-step.y, step.x);
      ++turns;
    } else {
      at += step;
      turns = 0;
    }
  }
  return path;
}

/// Returns images of regions that join late or never, or that lie inside one another.
std::vector<cv::Mat1w> shape_images(cv::Size size) {
  const int w = size.width, h = size.height;
  std::vector<cv::Mat1w> images = {
      paint(size, [](int, int) { return kNear; }),
      paint(size, [](int, int) { return kNone; }),
      paint(size, [&](int x, int y) { return x == w / 2 && y == h / 2 ? kNear : kNone; }),
      paint(size, [](int x, int y) { return (x + y) % 2 == 0 ? kNear : kFar; }),
      paint(size, [](int x, int y) { return (x + y) % 2 == 0 ? kNear : kNone; }),
      // Vertical stripes (each pixel of a row has its own label) and horizontal stripes.
      paint(size, [](int x, int) { return x % 2 == 0 ? kNear : kFar; }),
      paint(size, [](int, int y) { return y % 2 == 0 ? kNear : kFar; }),
      paint(size, [](int x, int) { return x % 3 == 0 ? kNear : kNone; }),
      paint(size, [](int x, int y) { return (x + y) / 2 % 2 == 0 ? kNear : kFar; }),
      // Combs whose teeth join in the last row, the first row, row 24, row 25 or the first column.
      paint(size, [&](int x, int y) { return x % 2 == 0 || y == h - 1 ? kNear : kNone; }),
      paint(size, [](int x, int y) { return x % 2 == 0 || y == 0 ? kNear : kFar; }),
      paint(size, [](int x, int y) { return x % 2 == 0 || y == 24 ? kNear : kNone; }),
      paint(size, [](int x, int y) { return x % 2 == 0 || y == 25 ? kNear : kNone; }),
      paint(size, [](int x, int y) { return y % 2 == 0 || x == 0 ? kNear : kNone; }),
      // Nested U shapes, nested arches and nested rings, separated by another disparity or by
      // invalid pixels.
      paint(size,
            [&](int x, int y) {
              return std::min({x, w - 1 - x, h - 1 - y}) % 2 == 0 ? kNear : kFar;
            }),
      paint(size,
            [&](int x, int y) {
              return std::min({x, w - 1 - x, y}) % 2 == 0 ? kNear : kFar;
            }),
      paint(size,
            [&](int x, int y) {
              return std::min({x, w - 1 - x, y}) % 2 == 0 ? kNear : kNone;
            }),
      paint(size,
            [&](int x, int y) {
              return std::min({x, w - 1 - x, y, h - 1 - y}) % 2 == 0 ? kNear : kFar;
            }),
      // Nested arches whose legs join in pairs, one pair in each row, from the inner to the outer.
      paint(size,
            [&](int x, int y) {
              const int ring = std::min({x, w - 1 - x, y});
              return ring % 2 == 0 || y == h - 1 - x / 2 ? kNear : kNone;
            }),
  };
  const cv::Mat1b path = spiral(size);
  for (const auto& [flip_x, flip_y] :
       {std::pair(false, false), std::pair(true, false), std::pair(false, true)}) {
    for (const int wall : {kNone, kFar}) {
      images.push_back(paint(size, [&, flip_x = flip_x, flip_y = flip_y, wall](int x, int y) {
        return path(flip_y ? h - 1 - y : y, flip_x ? w - 1 - x : x) != 0 ? kNear : wall;
      }));
    }
  }
  return images;
}

/// Returns random nested arches that do not cross, above rows that join some of their legs at
/// random.
cv::Mat1w random_arches(cv::Size size, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(random); };
  const int legs = (size.width + 1) / 2;
  cv::Mat1w image(size, kNoDisparity);
  std::vector<int> open, height(legs, 0);
  const int base = std::min(size.height - 1, 8 + below(8));
  for (int leg = 0; leg < legs; ++leg) {
    while (!open.empty() && below(2) != 0) {
      const int from = open.back();
      open.pop_back();
      const int above = *std::max_element(height.begin() + from, height.begin() + leg + 1) + 1;
      std::fill(height.begin() + from, height.begin() + leg + 1, above);
      if (base - 2 * above < 0) continue;
      image(cv::Range(base - 2 * above, base - 2 * above + 1), cv::Range(2 * from, 2 * leg + 1)) =
          kNear;
      for (const int x : {2 * from, 2 * leg}) {
        image(cv::Range(base - 2 * above, base), cv::Range(x, x + 1)) = kNear;
      }
    }
    if (below(4) != 0) open.push_back(leg);
  }
  const int joined = below(40);
  for (int y = base; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      if (below(100) < (x % 2 == 0 ? 92 : joined)) image(y, x) = kNear;
    }
  }
  return image;
}

template <class Model>
class RtlSpeckle : public ::testing::Test {};
using Models = ::testing::Types<SpeckleVga, SpeckleSmall>;
TYPED_TEST_SUITE(RtlSpeckle, Models);

constexpr int kSizes[] = {1, 2, 10, 100, 400, 1000};
constexpr int kRanges[] = {0, 1, 31};

TYPED_TEST(RtlSpeckle, EqualsSoftwareOnNoiseOfManyImageSizes) {
  unsigned seed = 0;
  for (const int width : {16, 17, 33, 64, 100}) {
    for (const int height : {1, 2, 5, 24, 25, 26, 60}) {
      if (width * height > 3000) continue;
      SCOPED_TRACE(::testing::Message() << width << " x " << height);
      Raster raster;
      raster.seed = ++seed;
      raster.bubble_rows = {height < 12 ? 12 : 0};
      compare<TypeParam>(noise_images({width, height}, 100 * seed),
                         speckle_parameters(kSizes[seed % 6], kRanges[seed % 3]), raster);
    }
  }
}

TYPED_TEST(RtlSpeckle, EqualsSoftwareAtManySpeckleSizesAndRanges) {
  for (const int size : {0, 1, 2, 10, 100, 400, 1000}) {
    for (const int range : kRanges) {
      compare<TypeParam>(noise_images({23, 29}, size + range), speckle_parameters(size, range), {});
    }
  }
}

TYPED_TEST(RtlSpeckle, EqualsSoftwareOnShapes) {
  for (const cv::Size size : {cv::Size(16, 31), cv::Size(17, 60), cv::Size(33, 26),
                              cv::Size(64, 40), cv::Size(100, 60)}) {
    SCOPED_TRACE(::testing::Message() << size);
    for (const int pixels : {2, 40, 400})
      compare<TypeParam>(shape_images(size), speckle_parameters(pixels, 1), {});
  }
  compare<TypeParam>(shape_images({31, 47}), speckle_parameters(1000, 31), {});
  compare<TypeParam>(shape_images({18, 3}), speckle_parameters(20, 0), {});
}

TYPED_TEST(RtlSpeckle, EqualsSoftwareOnArches) {
  for (const int width : {16, 35, 100}) {
    SCOPED_TRACE(width);
    for (const int pixels : {30, 200}) {
      std::vector<cv::Mat1w> images;
      for (unsigned seed = 0; seed < 30; ++seed) images.push_back(random_arches({width, 28}, seed));
      compare<TypeParam>(images, speckle_parameters(pixels, 1), {});
    }
  }
}

TYPED_TEST(RtlSpeckle, EqualsSoftwareWithStallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 40, 0, 24, 25, 26, 0};
  raster.stall_chance = 0.4;
  compare<TypeParam>(noise_images({19, 28}, 3), speckle_parameters(30, 1), raster);
}

TYPED_TEST(RtlSpeckle, EqualsSoftwareOnTinyFramesBackToBack) {
  for (const int height : {1, 2, 5, 11}) {
    Raster raster;
    raster.stall_chance = 0.1;
    std::vector<cv::Mat1w> images;
    for (const int pixels : {3, 16, 40}) {
      images = shape_images({16, height});
      const std::vector<cv::Mat1w> more = noise_images({16, height}, height);
      images.insert(images.end(), more.begin(), more.end());
      compare<TypeParam>(images, speckle_parameters(pixels, 1), raster);
    }
  }
}

TYPED_TEST(RtlSpeckle, RecoversFromAResetInTheMiddleOfAFrame) {
  const std::vector<cv::Mat1w> images = {noise({20, 45}, 0, 0, 0.41, 1), random_arches({20, 45}, 2),
                                         noise({20, 45}, 1, 100, 0.1, 3)};
  for (const int after : {7, 20 * 21 + 7, 20 * 44 + 19, 20 * 45, 20 * 60 + 3, 20 * 89 + 11}) {
    SCOPED_TRACE(after);
    Raster raster;
    raster.reset_after_ticks = after;
    compare<TypeParam>(images, speckle_parameters(60, 1), raster);
  }
}

TYPED_TEST(RtlSpeckle, HasTheDocumentedLatency) {
  for (const int width : {16, 31, 100}) {
    for (const int pixels : {0, 50}) {
      EXPECT_EQ(
          compare<TypeParam>({noise({width, 9}, 1, 100, 0.3, 5)}, speckle_parameters(pixels, 1), {})
              .latency_ticks,
          29 * width + 33);
    }
  }
}

// At full width, every pixel of a row belongs to its own open region, and the stack reaches its
// maximum depth.
template <class Model>
void check_full_width(int width) {
  compare<Model>({paint({width, 30}, [](int x, int) { return x % 2 == 0 ? kNear : kFar; }),
                  noise({width, 30}, 0, 0, 0.4, 1)},
                 speckle_parameters(27, 1), {});
  compare<Model>({paint({width, width / 2 + 2},
                        [&](int x, int y) {
                          return std::min({x, width - 1 - x, y}) % 2 == 0 ? kNear : kFar;
                        })},
                 speckle_parameters(1000, 1), {});
}
TEST(RtlSpeckleFullWidth, EqualsSoftwareAt640Columns) { check_full_width<SpeckleVga>(640); }
TEST(RtlSpeckleFullWidth, EqualsSoftwareAt100Columns) { check_full_width<SpeckleSmall>(100); }
TEST(RtlSpeckleFullWidth, EqualsSoftwareAt1280Columns) { check_full_width<SpeckleWide>(1280); }

}  // namespace
}  // namespace fpga_stereo::test
