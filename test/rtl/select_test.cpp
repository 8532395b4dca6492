// Compares fs_select with select().
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

/// The window sums of a frame: a D x W matrix for each row.
using Sums = std::vector<cv::Mat1w>;

/// Packs numbers of `bits` bits each into a port, the first in the lowest bits.
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

/// Sends the frames through the model and compares all outputs.
template <class Model>
RasterResult compare(const std::vector<Sums>& frames, Raster raster) {
  const auto [range, bits] = kBuild<Model>;
  raster.width = frames[0][0].cols;
  raster.height = static_cast<int>(frames[0].size());
  Parameters p = window_parameters();
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
  static constexpr int kMaxSum = (1 << kBuild<Model>.sum_bits) - 1;

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

  /// Random sums with `values` different values, up to `max_sum`.
  static Sums random_sums(cv::Size size, unsigned seed, int values = kMaxSum + 1,
                          int max_sum = kMaxSum) {
    std::mt19937 random(seed);
    return frame(size, [&](int, int, int) {
      return max_sum - static_cast<int>(random() % static_cast<unsigned>(values));
    });
  }

  static std::vector<Sums> sums_of_every_kind(cv::Size size, unsigned seed) {
    return {random_sums(size, seed),
            random_sums(size, seed + 1, 2),
            random_sums(size, seed + 2, 2, 1),
            random_sums(size, seed + 3, 5, 1000),
            random_sums(size, seed + 4, 40),
            frame(size, [](int, int, int) { return 0; }),
            frame(size, [](int, int, int) { return kMaxSum; }),
            frame(size, [](int, int, int) { return 1234; }),
            frame(size, [](int d, int, int) { return 7 * d; }),
            frame(size, [](int d, int, int) { return kMaxSum - 7 * d; }),
            frame(size, [](int d, int x, int) { return (13 * x + 29 * d) % 4096; }),
            frame(size, [](int d, int x, int) { return (13 * x + 4096 - 29 * d) % 4096; }),
            frame(size, [](int d, int x, int y) { return (d + x + y) % 2 * kMaxSum; })};
  }
};
using Models = ::testing::Types<Select16, Select20, Select64, Select64Wide, Select128>;
TYPED_TEST_SUITE(RtlSelect, Models);

TYPED_TEST(RtlSelect, EqualsSoftwareOnSumsOfEveryKindBackToBack) {
  for (const int width : {16, 17, 63, 64, 65, 100}) {
    SCOPED_TRACE(width);
    const int height = width < 32 ? 11 : 6;
    Raster raster;
    raster.seed = width;
    compare<TypeParam>(this->sums_of_every_kind({width, height}, width), raster);
  }
}

// Every disparity wins with every other one second, near and far, with equal and different sums.
// The winner's neighbours, which are never the runner-up, have sums between the two.
TYPED_TEST(RtlSelect, EqualsSoftwareForEveryWinnerAndRunnerUp) {
  for (const int margin : {0, 2}) {
    std::mt19937 random(margin);
    const Sums sums =
        this->frame({this->kRange, this->kRange}, [&](int d, int winner, int second) -> int {
          if (d == winner) return 100;
          if (d == second) return 100 + margin;
          if (std::abs(d - winner) == 1) return 100 + margin / 2;
          return 1000 + static_cast<int>(random() % 1000);
        });
    compare<TypeParam>({sums}, {});
  }
}

TYPED_TEST(RtlSelect, EqualsSoftwareWithMaxSumsAsRunnerUpsAndNeighbours) {
  const auto all_but_one = [&](int offset) {
    return this->frame({this->kRange, 2}, [&](int d, int x, int y) {
      return d == x ? this->kMaxSum - y - offset : this->kMaxSum;
    });
  };
  compare<TypeParam>({all_but_one(0), all_but_one(1), all_but_one(this->kMaxSum - 1)}, {});
}

TYPED_TEST(RtlSelect, EqualsSoftwareWithStallsAndBubbleRows) {
  Raster raster;
  raster.bubble_rows = {2, 1, 0, 3, 30, 0, 0, 1};
  raster.stall_chance = 0.4;
  compare<TypeParam>(this->sums_of_every_kind({25, 3}, 5), raster);
}

TYPED_TEST(RtlSelect, EqualsSoftwareOnFramesOfOneRow) {
  Raster raster;
  raster.bubble_rows = {0, 0, 0, 1, 0, 2};
  compare<TypeParam>(this->sums_of_every_kind({16, 1}, 9), raster);
}

TYPED_TEST(RtlSelect, RecoversFromAResetInTheMiddleOfAFrame) {
  for (const int ticks : {1, 16, 70, 30 * 7 + 13, 30 * 14 + 29}) {
    SCOPED_TRACE(ticks);
    Raster raster;
    raster.reset_after_ticks = ticks;
    compare<TypeParam>({this->random_sums({30, 7}, 1), this->random_sums({30, 7}, 2, 9)}, raster);
  }
}

TYPED_TEST(RtlSelect, HasTheDocumentedLatency) {
  for (const int width : {16, 100}) {
    EXPECT_EQ(compare<TypeParam>({this->random_sums({width, 2}, 3)}, {}).latency_ticks,
              this->kRange + 1);
  }
}

}  // namespace
}  // namespace fpga_stereo::test
