// fs_subpixel against subpixel().
#include <gtest/gtest.h>

#include <array>

#include "Subpixel128.h"
#include "Subpixel16.h"
#include "Subpixel64.h"
#include "core/stages.hpp"
#include "ports.hpp"
#include "raster.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

struct Build {
  int range, index_bits, sum_bits;
};
template <class Model>
constexpr Build kBuild{};
template <>
constexpr Build kBuild<Subpixel16>{16, 4, 13};
template <>
constexpr Build kBuild<Subpixel64>{64, 6, 15};
template <>
constexpr Build kBuild<Subpixel128>{128, 7, 16};

struct Input {
  Selection selection;  // winner and around
  cv::Mat1b kept;
};

/// Runs the frames through the model and compares the disparities.
template <class Model>
RasterResult compare(const std::vector<Input>& frames, Raster raster, bool switched_on = true) {
  constexpr int index_bits = kBuild<Model>.index_bits, sum_bits = kBuild<Model>.sum_bits;
  Parameters p;
  p.disparity_range = kBuild<Model>.range;
  p.subpixel = switched_on;
  raster.width = frames[0].kept.cols;
  raster.height = frames[0].kept.rows;
  std::vector<cv::Mat1w> actual;
  for (const Input& in : frames) actual.emplace_back(in.kept.size(), std::uint16_t{0});

  Model model;
  model.subpixel_i = switched_on;
  const RasterResult result = run_raster(
      model, raster, static_cast<int>(frames.size()),
      [&](int frame, int x, int y) {
        const Input& in = frames[frame];
        model.kept_i = in.kept(y, x);
        set_bits(model.winner_i, 0, index_bits, in.selection.winner(y, x));
        for (int k = 0; k < 5; ++k) {
          set_bits(model.around_i, k * sum_bits, sum_bits, in.selection.around(y, x)[k]);
        }
      },
      [&](std::mt19937& random) {
        model.kept_i = random() % 2;
        set_random(model.winner_i, index_bits, random);
        set_random(model.around_i, 5 * sum_bits, random);
      },
      [&](int frame, int x, int y) { actual[frame](y, x) = model.disparity_o; });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    cv::Mat1w expected;
    subpixel(frames[i].selection, frames[i].kept, p, cv::Range::all(), expected);
    EXPECT_TRUE(
        same("subpixel", expected, actual[i], {p, raster.seed, "frame " + std::to_string(i)}));
  }
  return result;
}

template <class Model>
class RtlSubpixel : public ::testing::Test {
 protected:
  static constexpr int kRange = kBuild<Model>.range;
  static constexpr int kLargest = (1 << kBuild<Model>.sum_bits) - 1;

  /// The five sums of pixel n are sums(n); `kept`: all pixels, and all refined.
  template <class Sums>
  static Input frame(cv::Size size, unsigned seed, const Sums& sums, bool kept = true) {
    std::mt19937 random(seed);
    Input in;
    create(in.selection, size);
    in.kept.create(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const std::array<int, 5> c = sums(y * size.width + x);
        for (int k = 0; k < 5; ++k) {
          in.selection.around(y, x)[k] = static_cast<std::uint16_t>(c[k]);
        }
        // Refined ones, else also those at the ends, not kept ones.
        const auto any = static_cast<int>(random() % 1024);
        const int d = kept ? 2 + any % (kRange - 4) : (kRange - 4 + any % 8) % kRange;
        in.selection.winner(y, x) = static_cast<std::uint8_t>(d);
        in.kept(y, x) = kept || random() % 4 > 0 ? 1 : 0;
      }
    }
    return in;
  }

  /// Random sums from `least` to `most`.
  static Input random(cv::Size size, unsigned seed, int least = 0, int most = kLargest,
                      bool kept = true) {
    std::mt19937 random(seed + 1000);
    return frame(
        size, seed,
        [&](int) {
          std::array<int, 5> c;
          for (int& sum : c) {
            sum = least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
          }
          return c;
        },
        kept);
  }
};
using Models = ::testing::Types<Subpixel16, Subpixel64, Subpixel128>;
TYPED_TEST_SUITE(RtlSubpixel, Models);

TYPED_TEST(RtlSubpixel, RandomSumsBackToBack) {
  for (const int width : {16, 17, 100}) {
    Raster raster;
    raster.seed = width;
    const cv::Size size(width, width < 32 ? 30 : 200);
    compare<TypeParam>({this->random(size, 1), this->random(size, 2, 0, 3),
                        this->random(size, 3, 0, 40), this->random(size, 4, 900, 1000),
                        this->random(size, 5, this->kLargest - 9), this->random(size, 6)},
                       raster);
  }
}

TYPED_TEST(RtlSubpixel, NotKeptAndNotRefined) {
  const Input in = this->random({200, 50}, 1, 0, this->kLargest, false);
  compare<TypeParam>({in}, {});
  compare<TypeParam>({in}, {}, false);
}

// Every combination of small sums: all small numerators and denominators, every tie of rounding.
// Then the same in large, and next to that.
TYPED_TEST(RtlSubpixel, AllSmallSumsAndTheirMultiples) {
  std::mt19937 random(1);
  const auto sums = [&](int n, int scale, int more) {
    std::array<int, 5> c;
    for (int& sum : c) {
      sum = n % 8 * scale + static_cast<int>(random() % static_cast<unsigned>(more + 1));
      n /= 8;
    }
    return c;
  };
  const int scale = this->kLargest / 8;
  compare<TypeParam>({this->frame({256, 128}, 1, [&](int n) { return sums(n, 1, 0); }),
                      this->frame({256, 128}, 2, [&](int n) { return sums(n, scale, 0); }),
                      this->frame({256, 128}, 3, [&](int n) { return sums(n, scale, 1); })},
                     {});
}

TYPED_TEST(RtlSubpixel, CombinationsOfExtremes) {
  const int values[] = {
      0, 1, this->kLargest / 2, this->kLargest / 2 + 1, this->kLargest - 1, this->kLargest};
  const auto sums = [&](int n) {
    std::array<int, 5> c;
    for (int& sum : c) {
      sum = values[n % 6];
      n /= 6;
    }
    return c;
  };
  compare<TypeParam>({this->frame({216, 36}, 1, sums)}, {});
}

// Parabolas with their vertex anywhere within a pixel and a half, as sums have them.
TYPED_TEST(RtlSubpixel, Parabolas) {
  std::mt19937 random(7);
  std::uniform_real_distribution<> vertex(-1.5, 1.5), opening(0.01, 1), noise(0, 0.01);
  const auto sums = [&](int) {
    std::array<int, 5> c;
    const double at = vertex(random), open = opening(random);
    for (int k = -2; k <= 2; ++k) {
      c[k + 2] = static_cast<int>(this->kLargest *
                                  (open * (k - at) * (k - at) / 12.5 + noise(random)) * 0.98);
    }
    return c;
  };
  compare<TypeParam>({this->frame({300, 60}, 2, sums), this->frame({300, 60}, 3, sums)}, {});
}

TYPED_TEST(RtlSubpixel, StallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 30, 0};
  raster.stalled = 0.4;
  std::vector<Input> frames;
  for (unsigned i = 0; i < 6; ++i) frames.push_back(this->random({25, 3}, i, 0, 500, false));
  compare<TypeParam>(frames, raster);
}

TYPED_TEST(RtlSubpixel, ResetInTheMiddleOfAFrame) {
  for (const int ticks : {5, 30 * 7 + 13, 30 * 14 + 5}) {
    Raster raster;
    raster.reset_after_ticks = ticks;
    compare<TypeParam>({this->random({30, 7}, 1), this->random({30, 7}, 2)}, raster);
  }
}

TYPED_TEST(RtlSubpixel, Latency) {
  for (const int width : {16, 100}) {
    EXPECT_EQ(compare<TypeParam>({this->random({width, 2}, 1)}, {}).latency_ticks, 11);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
