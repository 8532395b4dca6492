// Compares fs_subpixel with subpixel().
#include <gtest/gtest.h>

#include <array>

#include "Subpixel128.h"
#include "Subpixel16.h"
#include "Subpixel64.h"
#include "core/stages.hpp"
#include "ports.hpp"
#include "raster.hpp"
#include "rtl/configuration.hpp"
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

/// Sends the frames through the model and compares the disparities.
template <class Model>
RasterResult compare(const std::vector<Input>& frames, Raster raster, bool is_enabled = true) {
  constexpr int index_bits = kBuild<Model>.index_bits, sum_bits = kBuild<Model>.sum_bits;
  Parameters p = window_parameters();
  p.disparity_range = kBuild<Model>.range;
  p.subpixel = is_enabled;
  raster.width = frames[0].kept.cols;
  raster.height = frames[0].kept.rows;
  std::vector<cv::Mat1w> actual;
  for (const Input& in : frames) actual.emplace_back(in.kept.size(), std::uint16_t{0});

  Model model;
  set_config(model, p);
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
  static constexpr int kMaxSum = (1 << kBuild<Model>.sum_bits) - 1;

  /// The five sums of pixel n are sums(n). With `kept`, all pixels are kept and can be refined;
  /// otherwise some are not kept and some winners are too close to the ends of the search range.
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
        const auto any = static_cast<int>(random() % 1024);
        const int d = kept ? 2 + any % (kRange - 4) : (kRange - 4 + any % 8) % kRange;
        in.selection.winner(y, x) = static_cast<std::uint8_t>(d);
        in.kept(y, x) = kept || random() % 4 > 0 ? 1 : 0;
      }
    }
    return in;
  }

  /// Random sums from `min` to `max`.
  static Input random_input(cv::Size size, unsigned seed, int min = 0, int max = kMaxSum,
                            bool kept = true) {
    std::mt19937 random(seed + 1000);
    return frame(
        size, seed,
        [&](int) {
          std::array<int, 5> c;
          for (int& sum : c) {
            sum = min + static_cast<int>(random() % static_cast<unsigned>(max - min + 1));
          }
          return c;
        },
        kept);
  }
};
using Models = ::testing::Types<Subpixel16, Subpixel64, Subpixel128>;
TYPED_TEST_SUITE(RtlSubpixel, Models);

TYPED_TEST(RtlSubpixel, EqualsSoftwareOnRandomSumsBackToBack) {
  for (const int width : {16, 17, 100}) {
    Raster raster;
    raster.seed = width;
    const cv::Size size(width, width < 32 ? 30 : 200);
    compare<TypeParam>(
        {this->random_input(size, 1), this->random_input(size, 2, 0, 3),
         this->random_input(size, 3, 0, 40), this->random_input(size, 4, 900, 1000),
         this->random_input(size, 5, this->kMaxSum - 9), this->random_input(size, 6)},
        raster);
  }
}

TYPED_TEST(RtlSubpixel, EqualsSoftwareOnUnrefinedPixels) {
  const Input in = this->random_input({200, 50}, 1, 0, this->kMaxSum, false);
  compare<TypeParam>({in}, {});
  compare<TypeParam>({in}, {}, false);
}

// Every combination of small sums gives all small numerators and denominators and every rounding
// tie. The same combinations follow scaled up, and scaled up with a random 0 or 1 added to each
// sum.
TYPED_TEST(RtlSubpixel, EqualsSoftwareOnAllSmallSumsAndTheirMultiples) {
  std::mt19937 random(1);
  const auto sums = [&](int n, int scale, int max_noise) {
    std::array<int, 5> c;
    for (int& sum : c) {
      sum = n % 8 * scale + static_cast<int>(random() % static_cast<unsigned>(max_noise + 1));
      n /= 8;
    }
    return c;
  };
  const int scale = this->kMaxSum / 8;
  compare<TypeParam>({this->frame({256, 128}, 1, [&](int n) { return sums(n, 1, 0); }),
                      this->frame({256, 128}, 2, [&](int n) { return sums(n, scale, 0); }),
                      this->frame({256, 128}, 3, [&](int n) { return sums(n, scale, 1); })},
                     {});
}

TYPED_TEST(RtlSubpixel, EqualsSoftwareOnCombinationsOfExtremes) {
  const int values[] = {
      0, 1, this->kMaxSum / 2, this->kMaxSum / 2 + 1, this->kMaxSum - 1, this->kMaxSum};
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

// Noisy parabolas, as real window sums form them, with the vertex up to 1.5 px from the winner.
TYPED_TEST(RtlSubpixel, EqualsSoftwareOnParabolas) {
  std::mt19937 random(7);
  std::uniform_real_distribution<> vertex(-1.5, 1.5), opening(0.01, 1), noise(0, 0.01);
  const auto sums = [&](int) {
    std::array<int, 5> c;
    const double at = vertex(random), open = opening(random);
    for (int k = -2; k <= 2; ++k) {
      c[k + 2] = static_cast<int>(this->kMaxSum *
                                  (open * (k - at) * (k - at) / 12.5 + noise(random)) * 0.98);
    }
    return c;
  };
  compare<TypeParam>({this->frame({300, 60}, 2, sums), this->frame({300, 60}, 3, sums)}, {});
}

TYPED_TEST(RtlSubpixel, EqualsSoftwareWithStallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 30, 0};
  raster.stall_chance = 0.4;
  std::vector<Input> frames;
  for (unsigned i = 0; i < 6; ++i) frames.push_back(this->random_input({25, 3}, i, 0, 500, false));
  compare<TypeParam>(frames, raster);
}

TYPED_TEST(RtlSubpixel, RecoversFromAResetInTheMiddleOfAFrame) {
  for (const int ticks : {5, 30 * 7 + 13, 30 * 14 + 5}) {
    Raster raster;
    raster.reset_after_ticks = ticks;
    compare<TypeParam>({this->random_input({30, 7}, 1), this->random_input({30, 7}, 2)}, raster);
  }
}

TYPED_TEST(RtlSubpixel, HasTheDocumentedLatency) {
  for (const int width : {16, 100}) {
    EXPECT_EQ(compare<TypeParam>({this->random_input({width, 2}, 1)}, {}).latency_ticks, 11);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
