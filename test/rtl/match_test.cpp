// Compares fs_match with Match.
#include <gtest/gtest.h>

#include "MatchFull.h"
#include "MatchLarge.h"
#include "MatchSparse.h"
#include "core/census_window.hpp"
#include "core/stages.hpp"
#include "ports.hpp"
#include "raster.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

template <class Model>
Parameters build_parameters();
template <>
Parameters build_parameters<MatchSparse>() {
  Parameters p = window_parameters();
  p.disparity_range = 16;
  return p;
}
template <>
Parameters build_parameters<MatchFull>() {
  Parameters p = window_parameters();
  p.disparity_range = 20;
  p.census_pattern = CensusPattern::kFull;
  return p;
}
template <>
Parameters build_parameters<MatchLarge>() {
  Parameters p = window_parameters();
  p.disparity_range = 16;
  p.census_window_size = 7;
  p.correlation_window_size = 21;
  return p;
}

/// fs_match with a delay line for the census bits of the row that leaves the correlation window:
/// they are those that entered `delay_ticks` ticks earlier.
template <class Model>
class ModelWithCensusDelay : public Model {
 public:
  explicit ModelWithCensusDelay(std::size_t delay_ticks) : delay_(delay_ticks) {}

  void eval() {
    const bool rising = this->clk_i && !last_clock_;
    last_clock_ = this->clk_i;
    if (!this->clk_i && history_.size() >= delay_) {
      const auto& [left, right] = history_[history_.size() - delay_];
      this->leave_left_i = left;
      this->leave_right_i = right;
    }
    if (rising && this->en_i && this->rst_ni) {
      history_.emplace_back(this->enter_left_i, this->enter_right_i);
    }
    Model::eval();
  }

 private:
  using Port = std::remove_reference_t<decltype(Model::enter_left_i)>;
  std::size_t delay_;
  bool last_clock_ = false;
  std::vector<std::pair<Port, Port>> history_;
};

/// Returns the width in bits of a window sum.
int sum_bits(const Parameters& p) {
  const int window = p.correlation_window_size;
  const auto max_sum = static_cast<unsigned>(window * window * census_neighbours(p).size());
  int bits = 0;
  while (max_sum >> bits != 0) ++bits;
  return bits;
}

/// Sends each pair of census images through the model as one frame and compares every window sum.
template <class Model>
RasterResult compare(const std::vector<std::pair<cv::Mat, cv::Mat>>& pairs, Raster raster) {
  const Parameters p = build_parameters<Model>();
  const int bits = static_cast<int>(census_neighbours(p).size());
  const int range = p.disparity_range;
  raster.width = pairs[0].first.cols;
  raster.height = pairs[0].first.rows;
  // All disparities of a pixel lie side by side.
  const cv::Size size(raster.width * range, raster.height);

  std::vector<cv::Mat1w> expected, actual;
  for (const auto& [left, right] : pairs) {
    Match match;
    match.start(left, right, p, 0);
    expected.emplace_back(size);
    actual.emplace_back(size, 0);
    for (int y = 0; y < raster.height; ++y) {
      const cv::Mat1w& sums = match.next();
      for (int x = 0; x < raster.width; ++x) {
        for (int d = 0; d < range; ++d) expected.back()(y, x * range + d) = sums(d, x);
      }
    }
  }
  ModelWithCensusDelay<Model> model(static_cast<std::size_t>(p.correlation_window_size) *
                                    raster.width);
  model.width_i = raster.width;
  const int words = (bits + 31) / 32;
  const auto write = [&](auto& port, const cv::Mat& image, int x, int y) {
    for (int word = 0; word < words; ++word) {
      set_bits(port, 32 * word, std::min(32, bits - 32 * word),
               image.ptr<std::uint32_t>(y, x)[word]);
    }
  };
  const int width = sum_bits(p);
  const RasterResult result = run_raster(
      model, raster, static_cast<int>(pairs.size()),
      [&](int frame, int x, int y) {
        write(model.enter_left_i, pairs[frame].first, x, y);
        write(model.enter_right_i, pairs[frame].second, x, y);
      },
      [&](std::mt19937& random) {
        set_random(model.enter_left_i, bits, random);
        set_random(model.enter_right_i, bits, random);
      },
      [&](int frame, int x, int y) {
        for (int d = 0; d < range; ++d) {
          actual[frame](y, x * range + d) =
              static_cast<std::uint16_t>(get_bits(model.sums_o, d * width, width));
        }
      });
  for (std::size_t frame = 0; frame < pairs.size(); ++frame) {
    EXPECT_TRUE(same("match (x * D + d)", expected[frame], actual[frame],
                     {p, raster.seed, "frame " + std::to_string(frame)}));
  }
  return result;
}

/// Returns pairs of census images. A fill of 0 or 1 clears or sets every bit; -1 makes them random.
template <class Model>
std::vector<std::pair<cv::Mat, cv::Mat>> census_pairs(cv::Size size, int frames, unsigned seed,
                                                      int fill_left = -1, int fill_right = -1) {
  const auto bits = static_cast<int>(census_neighbours(build_parameters<Model>()).size());
  std::mt19937 random(seed);
  const auto image = [&](int fill) {
    cv::Mat out(size, CV_32SC((bits + 31) / 32));
    for (int y = 0; y < size.height; ++y) {
      for (int i = 0; i < size.width * out.channels(); ++i) {
        const int left = bits - 32 * (i % out.channels());
        const std::uint32_t mask = left >= 32 ? ~0U : (1U << left) - 1;
        const std::uint32_t value = fill < 0 ? random() : fill == 0 ? 0 : ~0U;
        out.ptr<std::uint32_t>(y)[i] = value & mask;
      }
    }
    return out;
  };
  std::vector<std::pair<cv::Mat, cv::Mat>> out;
  for (int i = 0; i < frames; ++i) out.emplace_back(image(fill_left), image(fill_right));
  return out;
}

template <class Model>
class RtlMatch : public ::testing::Test {
 protected:
  int min_width() const {
    return std::max(16, build_parameters<Model>().correlation_window_size + 1);
  }
  int radius() const { return build_parameters<Model>().correlation_window_size / 2; }
  /// Frames with the smallest gap between them.
  Raster raster() const {
    Raster raster;
    raster.bubble_rows = {radius()};
    return raster;
  }
};
using Models = ::testing::Types<MatchSparse, MatchFull, MatchLarge>;
TYPED_TEST_SUITE(RtlMatch, Models);

TYPED_TEST(RtlMatch, EqualsSoftwareAtManySizesWithTheSmallestGap) {
  const int width = this->min_width();
  const int height = this->radius() + 1;
  for (const cv::Size size :
       {cv::Size(width, height), cv::Size(width + 1, height + 1), cv::Size(width + 7, 2 * height),
        cv::Size(width + 20, 2 * height + 5), cv::Size(64, 3 * height)}) {
    SCOPED_TRACE(::testing::Message() << size);
    Raster raster = this->raster();
    raster.seed = size.width;
    compare<TypeParam>(census_pairs<TypeParam>(size, 3, 7 * size.height), raster);
  }
}

TYPED_TEST(RtlMatch, EqualsSoftwareAtHeightsBelowTheWindow) {
  for (int height = 1; height <= this->radius(); ++height) {
    SCOPED_TRACE(height);
    const int gap = this->radius();
    Raster raster;
    raster.bubble_rows = {1, gap, gap, gap + 1};
    compare<TypeParam>(census_pairs<TypeParam>({this->min_width(), height}, 5, height), raster);
  }
}

TYPED_TEST(RtlMatch, EqualsSoftwareWithStallsAndBubbleRows) {
  const int gap = this->radius();
  Raster raster;
  raster.bubble_rows = {2, gap + 1, gap, gap + 3, 30, gap + 12};
  raster.stall_chance = 0.4;
  compare<TypeParam>(census_pairs<TypeParam>({25, 17}, 7, 3), raster);
}

TYPED_TEST(RtlMatch, EqualsSoftwareAtMinAndMaxSums) {
  for (const int left : {0, 1}) {
    for (const int right : {0, 1}) {
      compare<TypeParam>(census_pairs<TypeParam>({40, 30}, 2, 1, left, right), this->raster());
    }
  }
}

TYPED_TEST(RtlMatch, RecoversFromAResetInTheMiddleOfAFrame) {
  Raster raster = this->raster();
  raster.reset_after_ticks = 30 * 26 + 30 * (this->radius() + 11) + 13;
  compare<TypeParam>(census_pairs<TypeParam>({30, 26}, 2, 11), raster);
}

TYPED_TEST(RtlMatch, HasTheDocumentedLatency) {
  const bool many_bits = census_neighbours(build_parameters<TypeParam>()).size() > 30;
  for (const int width : {24, 31}) {
    EXPECT_EQ(compare<TypeParam>(census_pairs<TypeParam>({width, 12}, 1, 1), {}).latency_ticks,
              this->radius() * width + this->radius() + (many_bits ? 10 : 9));
  }
}

}  // namespace
}  // namespace fpga_stereo::test
