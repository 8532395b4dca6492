// fs_select against select().
#include <gtest/gtest.h>

#include "Select128.h"
#include "Select16.h"
#include "Select20.h"
#include "Select64.h"
#include "Select64Wide.h"
#include "core/stages.hpp"
#include "ports.hpp"
#include "raster.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

struct Build {
  int range, sum_bits;
};
template <class Model>
constexpr Build kBuild{};
template <>
constexpr Build kBuild<Select16>{16, 13};
template <>
constexpr Build kBuild<Select20>{20, 13};
template <>
constexpr Build kBuild<Select64>{64, 13};
template <>
constexpr Build kBuild<Select64Wide>{64, 15};
template <>
constexpr Build kBuild<Select128>{128, 13};

/// The sums of a frame: of each row, D x W.
using Sums = std::vector<cv::Mat1w>;

/// Sets a port to numbers of `bits` bits each, the first in the lowest bits.
template <class Port>
void pack(Port& port, const std::vector<std::uint32_t>& numbers, int bits) {
  std::uint64_t word = 0;
  int filled = 0, at = 0;
  for (const std::uint32_t number : numbers) {
    word |= static_cast<std::uint64_t>(number) << filled;
    filled += bits;
    if (filled < 32) continue;
    port[at++] = static_cast<std::uint32_t>(word);
    word >>= 32;
    filled -= 32;
  }
  if (filled > 0) port[at] = static_cast<std::uint32_t>(word);
}

/// Runs the frames through the model and compares all outputs.
template <class Model>
RasterResult compare(const std::vector<Sums>& frames, Raster raster) {
  const auto [range, bits] = kBuild<Model>;
  raster.width = frames[0][0].cols;
  raster.height = static_cast<int>(frames[0].size());
  Parameters p;
  p.disparity_range = range;

  std::vector<Selection> expected(frames.size()), actual(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    create(expected[i], {raster.width, raster.height});
    create(actual[i], {raster.width, raster.height});
    for (int y = 0; y < raster.height; ++y) select(frames[i][y], y, expected[i]);
  }

  Model model;
  const int index_bits = range <= 16 ? 4 : range <= 32 ? 5 : range <= 64 ? 6 : 7;
  std::vector<std::uint32_t> numbers(range);
  const RasterResult result = run_raster(
      model, raster, static_cast<int>(frames.size()),
      [&](int frame, int x, int y) {
        for (int d = 0; d < range; ++d) numbers[d] = frames[frame][y](d, x);
        pack(model.sums_i, numbers, bits);
      },
      [&](std::mt19937& random) {
        for (std::uint32_t& number : numbers) number = random() % (1U << bits);
        pack(model.sums_i, numbers, bits);
      },
      [&](int frame, int x, int y) {
        Selection& s = actual[frame];
        const auto sum = [&](const auto& port, int i) {
          return static_cast<std::uint16_t>(get_bits(port, i * bits, bits));
        };
        s.winner(y, x) = static_cast<std::uint8_t>(get_bits(model.winner_o, 0, index_bits));
        s.right_winner(y, x) =
            static_cast<std::uint8_t>(get_bits(model.right_winner_o, 0, index_bits));
        s.winner_sum(y, x) = sum(model.winner_sum_o, 0);
        s.runner_up_sum(y, x) = sum(model.runner_up_sum_o, 0);
        for (int k = 0; k < 5; ++k) s.around(y, x)[k] = sum(model.around_o, k);
      });
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_TRUE(
        same("select", expected[i], actual[i], {p, raster.seed, "frame " + std::to_string(i)}));
  }
  return result;
}

template <class Model>
class RtlSelect : public ::testing::Test {
 protected:
  static constexpr int kRange = kBuild<Model>.range;
  static constexpr int kLargest = (1 << kBuild<Model>.sum_bits) - 1;

  /// sums(d, x, y) = value(d, x, y).
  template <class Value>
  static Sums frame(cv::Size size, const Value& value) {
    Sums out;
    for (int y = 0; y < size.height; ++y) {
      out.emplace_back(kRange, size.width);
      for (int d = 0; d < kRange; ++d) {
        for (int x = 0; x < size.width; ++x) {
          out[y](d, x) = static_cast<std::uint16_t>(value(d, x, y));
        }
      }
    }
    return out;
  }

  /// Random sums of `values` different ones, the largest of them `largest`.
  static Sums random(cv::Size size, unsigned seed, int values = kLargest + 1,
                     int largest = kLargest) {
    std::mt19937 random(seed);
    return frame(size, [&](int, int, int) {
      return largest - static_cast<int>(random() % static_cast<unsigned>(values));
    });
  }

  static std::vector<Sums> of_every_kind(cv::Size size, unsigned seed) {
    return {random(size, seed),
            random(size, seed + 1, 2),
            random(size, seed + 2, 2, 1),
            random(size, seed + 3, 5, 1000),
            random(size, seed + 4, 40),
            frame(size, [](int, int, int) { return 0; }),
            frame(size, [](int, int, int) { return kLargest; }),
            frame(size, [](int, int, int) { return 1234; }),
            frame(size, [](int d, int, int) { return 7 * d; }),
            frame(size, [](int d, int, int) { return kLargest - 7 * d; }),
            frame(size, [](int d, int x, int) { return (13 * x + 29 * d) % 4096; }),
            frame(size, [](int d, int x, int) { return (13 * x + 4096 - 29 * d) % 4096; }),
            frame(size, [](int d, int x, int y) { return (d + x + y) % 2 * kLargest; })};
  }
};
using Models = ::testing::Types<Select16, Select20, Select64, Select64Wide, Select128>;
TYPED_TEST_SUITE(RtlSelect, Models);

TYPED_TEST(RtlSelect, SumsOfEveryKindBackToBack) {
  for (const int width : {16, 17, 63, 64, 65, 100}) {
    SCOPED_TRACE(width);
    const int height = width < 32 ? 11 : 6;
    Raster raster;
    raster.seed = width;
    compare<TypeParam>(this->of_every_kind({width, height}, width), raster);
  }
}

// Each disparity wins with each other the second, near and far; their sums alike or not, and the
// winner's neighbours, which are no rivals, in between.
TYPED_TEST(RtlSelect, EveryWinnerAndRunnerUp) {
  for (const int more : {0, 2}) {
    std::mt19937 random(more);
    const Sums sums =
        this->frame({this->kRange, this->kRange}, [&](int d, int winner, int rival) -> int {
          if (d == winner) return 100;
          if (d == rival) return 100 + more;
          if (std::abs(d - winner) == 1) return 100 + more / 2;
          return 1000 + static_cast<int>(random() % 1000);
        });
    compare<TypeParam>({sums}, {});
  }
}

TYPED_TEST(RtlSelect, LargestSumsAsRunnerUpsAndNeighbours) {
  const auto all_but_one = [&](int offset) {
    return this->frame({this->kRange, 2}, [&](int d, int x, int y) {
      return d == x ? this->kLargest - y - offset : this->kLargest;
    });
  };
  compare<TypeParam>({all_but_one(0), all_but_one(1), all_but_one(this->kLargest - 1)}, {});
}

TYPED_TEST(RtlSelect, StallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 30, 0, 0, 1};
  raster.stalled = 0.4;
  compare<TypeParam>(this->of_every_kind({25, 3}, 5), raster);
}

TYPED_TEST(RtlSelect, FramesOfOneRow) {
  Raster raster;
  raster.bubble_rows = {0, 0, 0, 1, 0, 2};
  compare<TypeParam>(this->of_every_kind({16, 1}, 9), raster);
}

TYPED_TEST(RtlSelect, ResetInTheMiddleOfAFrame) {
  for (const int ticks : {1, 16, 70, 30 * 7 + 13, 30 * 14 + 29}) {
    SCOPED_TRACE(ticks);
    Raster raster;
    raster.reset_after_ticks = ticks;
    compare<TypeParam>({this->random({30, 7}, 1), this->random({30, 7}, 2, 9)}, raster);
  }
}

TYPED_TEST(RtlSelect, Latency) {
  for (const int width : {16, 100}) {
    EXPECT_EQ(compare<TypeParam>({this->random({width, 2}, 3)}, {}).latency_ticks,
              this->kRange + 1);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
