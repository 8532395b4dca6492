// Compares fs_check with check().
#include <gtest/gtest.h>

#include <algorithm>

#include "Check128.h"
#include "Check16.h"
#include "Check20.h"
#include "Check64.h"
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
constexpr Build kBuild<Check16>{16, 4, 13};
template <>
constexpr Build kBuild<Check20>{20, 5, 13};
template <>
constexpr Build kBuild<Check64>{64, 6, 13};
template <>
constexpr Build kBuild<Check128>{128, 7, 15};

/// Sends the frames through the model and compares the kept flags; winner and around must pass
/// through unchanged.
template <class Model>
RasterResult compare(const std::vector<Selection>& frames, const Parameters& p, Raster raster) {
  constexpr int index_bits = kBuild<Model>.index_bits, sum_bits = kBuild<Model>.sum_bits;
  const cv::Size size = frames[0].winner.size();
  raster.width = size.width;
  raster.height = size.height;
  std::vector<cv::Mat1b> kept(frames.size());
  std::vector<Selection> passed(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    kept[i].create(size);
    create(passed[i], size);
  }

  Model model;
  set_config(model, p);
  const RasterResult result = run_raster(
      model, raster, static_cast<int>(frames.size()),
      [&](int frame, int x, int y) {
        const Selection& s = frames[frame];
        set_bits(model.winner_i, 0, index_bits, s.winner(y, x));
        set_bits(model.right_winner_i, 0, index_bits, s.right_winner(y, x));
        set_bits(model.winner_sum_i, 0, sum_bits, s.winner_sum(y, x));
        set_bits(model.runner_up_sum_i, 0, sum_bits, s.runner_up_sum(y, x));
        for (int k = 0; k < 5; ++k) {
          set_bits(model.around_i, k * sum_bits, sum_bits, s.around(y, x)[k]);
        }
      },
      [&](std::mt19937& random) {
        set_random(model.winner_i, index_bits, random);
        set_random(model.right_winner_i, index_bits, random);
        set_random(model.winner_sum_i, sum_bits, random);
        set_random(model.runner_up_sum_i, sum_bits, random);
      },
      [&](int frame, int x, int y) {
        kept[frame](y, x) = model.kept_o;
        Selection& s = passed[frame];
        s.winner(y, x) = static_cast<std::uint8_t>(get_bits(model.winner_o, 0, index_bits));
        for (int k = 0; k < 5; ++k) {
          s.around(y, x)[k] =
              static_cast<std::uint16_t>(get_bits(model.around_o, k * sum_bits, sum_bits));
        }
      });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    cv::Mat1b expected;
    check(frames[i], p, cv::Range::all(), expected);
    const Case about{p, raster.seed, "frame " + std::to_string(i)};
    EXPECT_TRUE(same("check", expected, kept[i], about));
    EXPECT_TRUE(same("check winner", frames[i].winner, passed[i].winner, about));
    EXPECT_TRUE(same("check around", frames[i].around, passed[i].around, about));
  }
  return result;
}

template <class Model>
class RtlCheck : public ::testing::Test {
 protected:
  static constexpr int kRange = kBuild<Model>.range;
  static constexpr int kMaxSum = (1 << kBuild<Model>.sum_bits) - 1;

  static Parameters parameters() {
    Parameters p = window_parameters();
    p.disparity_range = kRange;
    return p;
  }

  /// Random winners and sums, most of them close to the thresholds of `p`.
  static Selection random_selection(cv::Size size, unsigned seed, const Parameters& p) {
    std::mt19937 random(seed);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    Selection s;
    create(s, size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        s.right_winner(y, x) = static_cast<std::uint8_t>(below(kRange));
        for (int k = 0; k < 5; ++k) s.around(y, x)[k] = static_cast<std::uint16_t>(below(kMaxSum));
        const int v1 = below(4) == 0 ? below(3) : below(kMaxSum + 1);
        const int v2 =
            below(8) == 0 ? below(kMaxSum + 1) : uniqueness_factor(p) * v1 / 256 + below(3) - 1;
        s.winner_sum(y, x) = static_cast<std::uint16_t>(v1);
        s.runner_up_sum(y, x) = static_cast<std::uint16_t>(std::clamp(v2, 0, kMaxSum));
      }
      for (int x = 0; x < size.width; ++x) {
        const int d = below(std::min(kRange, x + 2));
        s.winner(y, x) = static_cast<std::uint8_t>(d);
        const int offset = std::min(p.disp12MaxDiff, kRange) + 1 - below(3);
        const int right = std::clamp(below(2) == 0 ? d + offset : d - offset, 0, kRange - 1);
        if (x >= d) s.right_winner(y, x - d) = static_cast<std::uint8_t>(right);
      }
    }
    return s;
  }
};
using Models = ::testing::Types<Check16, Check20, Check64, Check128>;
TYPED_TEST_SUITE(RtlCheck, Models);

TYPED_TEST(RtlCheck, EqualsSoftwareAtManyWidthsBackToBack) {
  for (const int width : {16, 17, 63, 64, 65, 130, 300}) {
    SCOPED_TRACE(width);
    Raster raster;
    raster.seed = width;
    const Parameters p = this->parameters();
    std::vector<Selection> frames;
    for (unsigned i = 0; i < 4; ++i)
      frames.push_back(this->random_selection({width, 7}, width + i, p));
    compare<TypeParam>(frames, p, raster);
  }
}

TYPED_TEST(RtlCheck, EqualsSoftwareAtManyValuesOfDisp12MaxDiff) {
  for (const int difference : {0, 1, 2, 15, 16, 63, 64, 127, 128, 255}) {
    Parameters p = this->parameters();
    p.uniqueness_check = false;
    p.disp12MaxDiff = difference;
    compare<TypeParam>({this->random_selection({200, 20}, difference, p)}, p, {});
  }
}

TYPED_TEST(RtlCheck, EqualsSoftwareAtManyUniquenessRatios) {
  for (const double ratio : {0.0, 0.2, 1.0, 33.0, 50.0, 99.7, 100.0, 299.6}) {
    Parameters p = this->parameters();
    p.left_right_check = false;
    p.uniqueness_ratio = ratio;
    ASSERT_LT(uniqueness_factor(p), 1024);
    compare<TypeParam>({this->random_selection({64, 40}, static_cast<unsigned>(ratio), p)}, p, {});
  }
}

// Limits of the ranges: x - dL = 0 and -1, the largest sums and winners.
TYPED_TEST(RtlCheck, EqualsSoftwareAtTheLimitsOfTheRanges) {
  Selection s;
  create(s, {this->kRange + 3, 4});
  const int last = this->kRange - 1;
  for (int x = 0; x < s.winner.cols; ++x) {
    const auto falling = static_cast<std::uint8_t>(std::max(last - x, 0));
    s.winner(0, x) = static_cast<std::uint8_t>(std::min(x, last));
    s.winner(1, x) = static_cast<std::uint8_t>(std::min(x + 1, last));
    s.winner(2, x) = static_cast<std::uint8_t>(last);
    s.winner(3, x) = static_cast<std::uint8_t>(x % 2 == 0 ? 0 : last);
    for (int y = 0; y < 4; ++y) {
      s.right_winner(y, x) = y == 2 ? static_cast<std::uint8_t>(last) : falling;
      s.winner_sum(y, x) = static_cast<std::uint16_t>(x % 3 == 0 ? this->kMaxSum : 0);
      s.runner_up_sum(y, x) = static_cast<std::uint16_t>(x % 2 == 0 ? this->kMaxSum : 0);
      s.around(y, x) = {0, 1, 2, 3, static_cast<std::uint16_t>(this->kMaxSum)};
    }
  }
  for (const bool left_right : {false, true}) {
    for (const bool uniqueness : {false, true}) {
      for (const int difference : {0, this->kRange - 2, this->kRange - 1}) {
        for (const double ratio : {0.0, 100.0}) {
          Parameters p = this->parameters();
          p.left_right_check = left_right;
          p.uniqueness_check = uniqueness;
          p.disp12MaxDiff = difference;
          p.uniqueness_ratio = ratio;
          compare<TypeParam>({s, s}, p, {});
        }
      }
    }
  }
}

TYPED_TEST(RtlCheck, EqualsSoftwareWithStallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 30, 0};
  raster.stall_chance = 0.4;
  const Parameters p = this->parameters();
  std::vector<Selection> frames;
  for (unsigned i = 0; i < 6; ++i) frames.push_back(this->random_selection({25, 3}, i, p));
  compare<TypeParam>(frames, p, raster);
}

TYPED_TEST(RtlCheck, RecoversFromAResetInTheMiddleOfAFrame) {
  for (const int ticks : {2, 30 * 7 + 13, 30 * 14 + 1}) {
    Raster raster;
    raster.reset_after_ticks = ticks;
    const Parameters p = this->parameters();
    compare<TypeParam>(
        {this->random_selection({30, 7}, 1, p), this->random_selection({30, 7}, 2, p)}, p, raster);
  }
}

TYPED_TEST(RtlCheck, HasTheDocumentedLatency) {
  const Parameters p = this->parameters();
  for (const int width : {16, 100}) {
    EXPECT_EQ(compare<TypeParam>({this->random_selection({width, 2}, 1, p)}, p, {}).latency_ticks,
              3);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
