// Kernels one by one against their scalar twins, on every target of this machine: after every
// stage, and with values that no image gives.
#include <gtest/gtest.h>

#include "core/census_window.hpp"
#include "core/pipeline_rig.hpp"
#include "core/simd/kernels.hpp"
#include "core/simd/regions.hpp"
#include "core/simd/row_matcher.hpp"
#include "core/stages.hpp"
#include "fpga_stereo/core/target.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

std::vector<std::string> simd_targets() {
  std::vector<std::string> names = targets();
  names.pop_back();  // scalar
  return names;
}

class Kernels : public ::testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { ASSERT_TRUE(choose_target(GetParam())); }
  void TearDown() override { ASSERT_TRUE(choose_target(targets().front())); }
};

/// The byte planes of an image's census, from an image with a border of 255.
simd::CensusPlanes planes_of(const cv::Mat1b& image, const Parameters& p) {
  cv::Mat1b bordered;
  cv::copyMakeBorder(image, bordered, 5, 5, simd::kBorder, simd::kBorder, cv::BORDER_CONSTANT, 255);
  const auto pitch = static_cast<std::ptrdiff_t>(bordered.step[0]);
  std::vector<std::ptrdiff_t> distances;
  for (const cv::Point& n : census_neighbours(p)) distances.push_back(n.y * pitch + n.x);
  simd::CensusPlanes planes;
  const int count = (static_cast<int>(distances.size()) + 7) / 8;
  planes.create(image.size(), count, simd::padded_range(p.disparity_range));
  for (int y = 0; y < image.rows; ++y) {
    simd::census_row(bordered[y + 5] + simd::kBorder, image.cols, distances, planes.row(y),
                     planes.pitch);
  }
  return planes;
}

TEST_P(Kernels, Census) {
  Parameters p;
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    for (int window = 5; window <= 11; window += 2) {
      p.census_pattern = pattern;
      p.census_window_size = window;
      for (const NamedImage& input : extreme_images({75, 23}, 20)) {
        const cv::Mat1b& image = input.image;
        cv::Mat expected;
        census(image, p, cv::Range::all(), expected);
        const simd::CensusPlanes planes = planes_of(image, p);
        for (int y = 0; y < image.rows; ++y) {
          for (int x = 0; x < image.cols; ++x) {
            const auto* words = expected.ptr<std::uint32_t>(y, x);
            for (int plane = 0; plane < planes.planes; ++plane) {
              const std::uint32_t byte = words[plane / 4] >> (plane % 4 * 8) & 0xFF;
              ASSERT_EQ(byte, planes.row(y)[plane * planes.pitch + x])
                  << input.name << " x " << x << " y " << y << " plane " << plane
                  << Case{p, 20, ""};
            }
          }
        }
      }
    }
  }
}

TEST_P(Kernels, MatchAndSelect) {
  unsigned seed = 21;
  for (const cv::Size size : {cv::Size(1, 1), {5, 9}, {40, 20}, {97, 30}}) {
    for (const int range : {8, 28, 64, 128, 256}) {
      for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
        Parameters p;
        p.disparity_range = range;
        p.census_pattern = pattern;
        p.correlation_window_size = range == 28 ? 21 : 9;
        const cv::Mat1b left = random_image(size, ++seed), right = random_image(size, ++seed);
        cv::Mat left_bits, right_bits;
        census(left, p, cv::Range::all(), left_bits);
        census(right, p, cv::Range::all(), right_bits);
        const simd::CensusPlanes left_planes = planes_of(left, p),
                                 right_planes = planes_of(right, p);
        const int first = size.height / 3;
        Match match;
        match.start(left_bits, right_bits, p, first);
        simd::RowMatcher matcher;
        matcher.start(left_planes, right_planes, size.width, p,
                      static_cast<int>(census_neighbours(p).size()), first);
        Selection expected;
        create(expected, size);
        for (int y = first; y < size.height; ++y) {
          select(match.next(), y, expected);
          const simd::SelectedRow& row = matcher.next();
          const Case c{p, seed, "row " + std::to_string(y)};
          const auto row_of = [&](auto* data) {
            using T = std::remove_pointer_t<decltype(data)>;
            return cv::Mat_<T>(1, size.width, data);
          };
          ASSERT_TRUE(same("winner", expected.winner.row(y), row_of(row.winner), c));
          ASSERT_TRUE(same("winner_sum", expected.winner_sum.row(y), row_of(row.winner_sum), c));
          ASSERT_TRUE(
              same("runner_up_sum", expected.runner_up_sum.row(y), row_of(row.runner_up_sum), c));
          ASSERT_TRUE(same("right", expected.right_winner.row(y), row_of(row.right_winner), c));
          for (int x = 0; x < size.width; ++x) {
            for (int k = 0; k < 5; ++k) {
              const int d = row.winner[x] + k - 2;
              if (d < 0 || d >= range) continue;  // subpixel does not look there
              ASSERT_EQ(expected.around(y, x)[k], row.around[k][x]) << x << " " << k << " " << c;
            }
          }
        }
      }
    }
  }
}

/// A row of what select could have found, and the same as images of the scalar twins.
struct Selected {
  static constexpr int kMostDisparities = 256;
  explicit Selected(int width)
      : bytes(2, kMostDisparities + width + simd::kBorder), words(7, width + simd::kBorder) {
    create(images, {width, 1});
    row = {bytes[0] + kMostDisparities,
           bytes[1] + kMostDisparities,
           words[0],
           words[1],
           {words[2], words[3], words[4], words[5], words[6]}};
  }
  void copy() {
    const int width = images.winner.cols;
    for (int x = 0; x < width; ++x) {
      images.winner(0, x) = row.winner[x];
      images.right_winner(0, x) = row.right_winner[x];
      images.winner_sum(0, x) = row.winner_sum[x];
      images.runner_up_sum(0, x) = row.runner_up_sum[x];
      for (int k = 0; k < 5; ++k) images.around(0, x)[k] = row.around[k][x];
    }
  }
  cv::Mat1b bytes;
  cv::Mat1w words;
  simd::SelectedRow row{};
  Selection images;
};

TEST_P(Kernels, CheckAndSubpixel) {
  constexpr int kWidth = 1003;
  cv::RNG rng(22);
  for (const int most : {3, 60, 5400, 52920}) {
    for (const int range : {8, 64, 256}) {
      Selected s(kWidth);
      for (int x = 0; x < kWidth; ++x) {
        s.row.winner[x] = static_cast<std::uint8_t>(rng.uniform(0, range));
        s.row.right_winner[x] = static_cast<std::uint8_t>(
            rng.uniform(0, 2) != 0 ? rng.uniform(0, range) : s.row.winner[x]);
        s.row.winner_sum[x] = static_cast<std::uint16_t>(rng.uniform(0, most + 1));
        s.row.runner_up_sum[x] = static_cast<std::uint16_t>(rng.uniform(0, most + 1));
        for (auto* sums : s.row.around) {
          // Both ends often: the steepest and the flattest parabolas.
          const int kind = rng.uniform(0, 4);
          sums[x] = static_cast<std::uint16_t>(kind == 0   ? 0
                                               : kind == 1 ? most
                                                           : rng.uniform(0, most + 1));
        }
      }
      s.copy();
      for (int switches = 0; switches < 8; ++switches) {
        Parameters p;
        p.disparity_range = range;
        p.left_right_check = (switches & 1) != 0;
        p.uniqueness_check = (switches & 2) != 0;
        p.subpixel = (switches & 4) != 0;
        p.disp12MaxDiff = switches;
        const Case c{p, 22, "most " + std::to_string(most)};
        cv::Mat1b kept, expected_kept;
        kept.create(1, kWidth + simd::kBorder);
        check(s.images, p, cv::Range::all(), expected_kept);
        simd::check_row(s.row, kWidth, p.left_right_check, p.disp12MaxDiff, p.uniqueness_check,
                        uniqueness_factor(p), kept[0]);
        ASSERT_TRUE(same("check", expected_kept, kept.colRange(0, kWidth), c));
        cv::Mat1w disparity, expected;
        disparity.create(1, kWidth + simd::kBorder);
        subpixel(s.images, expected_kept, p, cv::Range::all(), expected);
        simd::subpixel_row(s.row, kept[0], kWidth, range, p.subpixel, disparity[0]);
        ASSERT_TRUE(same("subpixel", expected, disparity.colRange(0, kWidth), c));
      }
    }
  }
}

TEST_P(Kernels, Speckle) {
  cv::RNG rng(23);
  simd::Regions regions;
  for (const cv::Size size : {cv::Size(1, 1), {1, 60}, {63, 50}, {64, 30}, {65, 30}, {200, 90}}) {
    for (const int levels : {1, 2, 5, 200}) {
      for (const double holes : {0.0, 0.1, 0.4, 0.6}) {
        cv::Mat1w wide(size.height, size.width + 2 * simd::kBorder, kNoDisparity);
        cv::Mat1w disparity = wide(cv::Rect({simd::kBorder, 0}, size));
        for (auto& value : disparity) {
          if (rng.uniform(0.0, 1.0) < holes) continue;
          value = static_cast<std::uint16_t>(rng.uniform(0, levels) * 33 + rng.uniform(0, 3));
        }
        for (const int least : {1, 2, 7, 60, 400}) {
          Parameters p;
          p.speckle_size = least;
          p.speckle_range = least % 3;
          cv::Mat1w expected = disparity.clone();
          speckle(p, expected);
          cv::Mat1w copy = wide.clone();
          cv::Mat1w actual = copy(cv::Rect({simd::kBorder, 0}, size));
          regions.remove_small(actual, p.speckle_range * kDisparityScale, p.speckle_size);
          ASSERT_TRUE(
              same("speckle", expected, actual, {p, 23, std::to_string(levels) + " levels"}));
        }
      }
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<std::string>& info) { return info.param; }
INSTANTIATE_TEST_SUITE_P(Targets, Kernels, ::testing::ValuesIn(simd_targets()), name_of);

}  // namespace
}  // namespace fpga_stereo::test
