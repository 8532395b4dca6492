// Compares fs_census with census().
#include <gtest/gtest.h>

#include "CensusFull.h"
#include "CensusSmall.h"
#include "CensusSparse.h"
#include "core/census_window.hpp"
#include "core/stages.hpp"
#include "ports.hpp"
#include "raster.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

Parameters census_parameters(int census, CensusPattern pattern, int correlation) {
  Parameters p = window_parameters();
  p.census_window_size = census;
  p.census_pattern = pattern;
  p.correlation_window_size = correlation;
  return p;
}

template <class Model>
Parameters build_parameters();
template <>
Parameters build_parameters<CensusSparse>() {
  return census_parameters(11, CensusPattern::kSparse, 15);
}
template <>
Parameters build_parameters<CensusFull>() {
  return census_parameters(11, CensusPattern::kFull, 15);
}
template <>
Parameters build_parameters<CensusSmall>() {
  return census_parameters(7, CensusPattern::kSparse, 5);
}

struct Images {
  cv::Mat1b left, right;
};

/// Sends each image pair through the model as one frame and compares all four outputs.
template <class Model>
RasterResult compare(const std::vector<Images>& images, Raster raster) {
  const Parameters p = build_parameters<Model>();
  const int bits = static_cast<int>(census_neighbours(p).size());
  const int words = (bits + 31) / 32;
  const int window = p.correlation_window_size;
  raster.width = images[0].left.cols;
  raster.height = images[0].left.rows;
  const auto frames = static_cast<int>(images.size());

  std::vector<cv::Mat> enter[2], leave[2], expected[2];
  for (const Images& pair : images) {
    for (int camera = 0; camera < 2; ++camera) {
      cv::Mat out;
      census(camera == 0 ? pair.left : pair.right, p, cv::Range::all(), out);
      expected[camera].push_back(out);
      enter[camera].emplace_back(out.size(), out.type(), cv::Scalar::all(0));
      leave[camera].emplace_back(out.size(), out.type(), cv::Scalar::all(0));
    }
  }
  Model model;
  model.width_i = raster.width;
  model.height_i = raster.height;
  const auto read = [&](const auto& port, cv::Mat& image, int x, int y) {
    for (int word = 0; word < words; ++word) {
      image.ptr<std::uint32_t>(y, x)[word] =
          get_bits(port, 32 * word, std::min(32, bits - 32 * word));
    }
  };
  const RasterResult result = run_raster(
      model, raster, frames,
      [&](int frame, int x, int y) {
        model.left_i = images[frame].left(y, x);
        model.right_i = images[frame].right(y, x);
      },
      [&](std::mt19937& random) {
        model.left_i = random() & 255;
        model.right_i = random() & 255;
      },
      [&](int frame, int x, int y) {
        read(model.enter_left_o, enter[0][frame], x, y);
        read(model.enter_right_o, enter[1][frame], x, y);
        read(model.leave_left_o, leave[0][frame], x, y);
        read(model.leave_right_o, leave[1][frame], x, y);
      });
  for (int frame = 0; frame < frames; ++frame) {
    for (int camera = 0; camera < 2; ++camera) {
      const std::string about =
          "camera " + std::to_string(camera) + ", frame " + std::to_string(frame);
      EXPECT_TRUE(
          same("census", expected[camera][frame], enter[camera][frame], {p, raster.seed, about}));
      const int leaving = raster.height - window;
      if (leaving > 0) {
        EXPECT_TRUE(same("leaving census", expected[camera][frame].rowRange(0, leaving),
                         leave[camera][frame].rowRange(window, raster.height),
                         {p, raster.seed, about}));
      }
    }
  }
  return result;
}

std::vector<Images> random_pairs(cv::Size size, int frames, unsigned seed) {
  std::vector<Images> pairs;
  for (int i = 0; i < frames; ++i) {
    pairs.push_back({random_image(size, seed + 2 * i), random_image(size, seed + 2 * i + 1)});
  }
  return pairs;
}

template <class Model>
class RtlCensus : public ::testing::Test {};
using Models = ::testing::Types<CensusSparse, CensusFull, CensusSmall>;
TYPED_TEST_SUITE(RtlCensus, Models);

TYPED_TEST(RtlCensus, EqualsSoftwareAtManySizesBackToBack) {
  for (const cv::Size size : {cv::Size(16, 1), cv::Size(16, 2), cv::Size(17, 5), cv::Size(16, 12),
                              cv::Size(23, 31), cv::Size(64, 20)}) {
    SCOPED_TRACE(::testing::Message() << size);
    Raster raster;
    raster.seed = size.width;
    compare<TypeParam>(random_pairs(size, 3, 7 * size.height), raster);
  }
}

TYPED_TEST(RtlCensus, EqualsSoftwareWithStallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 40};
  raster.stall_chance = 0.4;
  compare<TypeParam>(random_pairs({19, 22}, 6, 3), raster);
}

TYPED_TEST(RtlCensus, EqualsSoftwareOnExtremeImages) {
  std::vector<Images> pairs;
  for (const NamedImage& named : extreme_images({18, 19}, 5)) {
    pairs.push_back({named.image, 255 - named.image});
  }
  compare<TypeParam>(pairs, {});
}

TYPED_TEST(RtlCensus, RecoversFromAResetInTheMiddleOfAFrame) {
  Raster raster;
  raster.reset_after_ticks = 20 * 21 + 20 * 9 + 7;
  compare<TypeParam>(random_pairs({20, 21}, 2, 11), raster);
}

TYPED_TEST(RtlCensus, HasTheDocumentedLatency) {
  const int radius = build_parameters<TypeParam>().census_window_size / 2;
  const bool full = build_parameters<TypeParam>().census_pattern == CensusPattern::kFull;
  const int reach = full ? radius : radius / 2 * 2;
  for (const int width : {16, 31}) {
    EXPECT_EQ(compare<TypeParam>(random_pairs({width, 9}, 1, 1), {}).latency_ticks,
              reach * width + reach + 2);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
