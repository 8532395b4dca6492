// Every SIMD stage against its scalar twin, on every target of this machine: on images, and with
// values that no image gives.
#include <gtest/gtest.h>

#include <thread>

#include "core/pipeline_rig.hpp"
#include "core/simd/stage_timer.hpp"
#include "core/simd/stages.hpp"
#include "core/simd_rig.hpp"
#include "core/stages.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

/// Packs byte planes as the scalar stage packs census bits.
cv::Mat packed(const simd::CensusPlanes& planes) {
  const int words = (planes.bits + 31) / 32;
  cv::Mat bits(planes.height, planes.width, CV_32SC(words));
  for (int y = 0; y < planes.height; ++y) {
    auto* row = bits.ptr<std::uint32_t>(y);
    std::fill_n(row, planes.width * words, 0U);
    for (int x = 0; x < planes.width; ++x) {
      for (int i = 0; i < planes.count; ++i) {
        const std::uint32_t byte = planes.row(y)[i * planes.pitch + x];
        row[x * words + i / 4] |= byte << (i % 4 * 8);
      }
    }
  }
  return bits;
}

/// Converts a row that SIMD selected to images of one row.
Selection to_selection(const simd::SelectionRow& row) {
  Selection s;
  create(s, {row.width, 1});
  for (int x = 0; x < row.width; ++x) {
    s.winner(0, x) = row.winner[x];
    s.right_winner(0, x) = row.right_winner[x];
    s.winner_sum(0, x) = row.winner_sum[x];
    s.runner_up_sum(0, x) = row.runner_up_sum[x];
    for (int k = 0; k < 5; ++k) s.around(0, x)[k] = row.around[k][x];
  }
  return s;
}

/// Sets the sums of neighbours outside the search range to 0, as the scalar stage does.
void clear_outside(int range, Selection& s) {
  for (int x = 0; x < s.winner.cols; ++x) {
    for (int k = 0; k < 5; ++k) {
      const int d = s.winner(0, x) + k - 2;
      if (d < 0 || d >= range) s.around(0, x)[k] = 0;
    }
  }
}

Selection row_of(const Selection& s, int y) {
  return {s.winner.row(y), s.right_winner.row(y), s.winner_sum.row(y), s.runner_up_sum.row(y),
          s.around.row(y)};
}

TEST_P(SimdStages, Rectify) {
  unsigned seed = 30;
  for (const cv::Size size : {cv::Size(1, 1), {7, 9}, {8, 8}, {40, 20}, {101, 33}}) {
    for (const int max_units : {1, 100, 3000, 32767}) {
      const Mesh mesh = random_rectification(size, ++seed, max_units).left.mesh;
      for (const cv::Mat& raw :
           {cv::Mat(random_image(size, seed)), cv::Mat(random_color_image(size, seed))}) {
        const Case c{{}, seed, std::to_string(raw.channels()) + " channels"};
        cv::Mat expected;
        rectify(raw, mesh, cv::Range::all(), expected);
        const cv::Mat input = padded(raw, seed);
        cv::Mat actual(size, raw.type(), cv::Scalar::all(1));
        simd::rectify(input, mesh, {0, size.height}, actual);
        ASSERT_TRUE(same("rectify by mesh", expected, actual, c));
        simd::SourceTable sources;
        sources.create(mesh, size);
        actual.setTo(1);
        simd::rectify(input, sources, {0, size.height}, actual);
        ASSERT_TRUE(same("rectify by table", expected, actual, c));
      }
    }
  }
}

TEST_P(SimdStages, SourceTableFollowsMeshAndSize) {
  const cv::Size size(64, 24);
  simd::SourceTable sources;
  for (const unsigned seed : {1U, 2U, 2U}) {
    for (const cv::Size raw_size : {size, cv::Size(80, 30)}) {
      const Mesh mesh = random_rectification(size, seed).left.mesh;
      const cv::Mat raw = random_image(raw_size, seed);
      cv::Mat expected, actual(size, CV_8UC1);
      rectify(raw, mesh, cv::Range::all(), expected);
      sources.create(mesh, raw_size);
      simd::rectify(raw, sources, {0, size.height}, actual);
      ASSERT_TRUE(same("rectify", expected, actual, {{}, seed, ""}));
    }
  }
}

TEST_P(SimdStages, Census) {
  Parameters p = window_parameters();
  for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
    for (int window = 5; window <= 11; window += 2) {
      p.census_pattern = pattern;
      p.census_window_size = window;
      for (const NamedImage& input : extreme_images({75, 23}, 20)) {
        cv::Mat expected;
        census(input.image, p, cv::Range::all(), expected);
        ASSERT_TRUE(
            same("census", expected, packed(simd_census(input.image, p)), {p, 20, input.name}));
      }
    }
  }
}

TEST_P(SimdStages, MatchAndSelect) {
  unsigned seed = 21;
  for (const cv::Size size : {cv::Size(1, 1), {5, 9}, {40, 20}, {97, 30}}) {
    for (const int range : {8, 28, 64, 128, 256}) {
      for (const CensusPattern pattern : {CensusPattern::kSparse, CensusPattern::kFull}) {
        Parameters p = window_parameters();
        p.disparity_range = range;
        p.census_pattern = pattern;
        p.correlation_window_size = range == 28 ? 21 : 9;
        const cv::Mat1b left = random_image(size, ++seed), right = random_image(size, ++seed);
        cv::Mat left_bits, right_bits;
        census(left, p, cv::Range::all(), left_bits);
        census(right, p, cv::Range::all(), right_bits);
        const simd::CensusPlanes left_planes = simd_census(left, p),
                                 right_planes = simd_census(right, p);
        const int first = size.height / 3;
        Match match;
        match.start(left_bits, right_bits, p, first);
        simd::Match simd_match;
        simd_match.start(left_planes, right_planes, p, first);
        Selection expected;
        create(expected, size);
        simd::SelectionBuffer selected;
        selected.create(size.width, range);
        for (int y = first; y < size.height; ++y) {
          const Case c{p, seed, "row " + std::to_string(y)};
          const cv::Mat1w& sums = match.next();
          select(sums, y, expected);
          for (int x = 0; x < size.width;) {
            const simd::WindowSums& block = simd_match.next();
            ASSERT_EQ(block.begin, x);
            for (; x < block.end; ++x) {
              for (int d = 0; d < range; ++d) {
                ASSERT_EQ(sums(d, x), block.column(x)[block.lanes - 1 - d])
                    << "match at x " << x << ", d " << d << "; " << c;
              }
            }
            simd::select(block, selected.row());
          }
          Selection actual = to_selection(selected.row());
          clear_outside(range, actual);
          ASSERT_TRUE(same("select", row_of(expected, y), actual, c));
        }
      }
    }
  }
}

TEST_P(SimdStages, CheckAndSubpixel) {
  constexpr int kWidth = 1003;
  cv::RNG rng(22);
  for (const int max_sum : {3, 60, 5400, 52920}) {
    for (const int range : {8, 64, 256}) {
      simd::SelectionBuffer buffer;
      buffer.create(kWidth, range);
      const simd::SelectionRow& row = buffer.row();
      for (int x = 0; x < kWidth; ++x) {
        row.winner[x] = static_cast<std::uint8_t>(rng.uniform(0, range));
        row.right_winner[x] = static_cast<std::uint8_t>(
            rng.uniform(0, 2) != 0 ? rng.uniform(0, range) : row.winner[x]);
        row.winner_sum[x] = static_cast<std::uint16_t>(rng.uniform(0, max_sum + 1));
        row.runner_up_sum[x] = static_cast<std::uint16_t>(rng.uniform(0, max_sum + 1));
        for (auto* sums : row.around) {
          // Both extremes often: the steepest and the flattest parabolas.
          const int kind = rng.uniform(0, 4);
          sums[x] = static_cast<std::uint16_t>(kind == 0   ? 0
                                               : kind == 1 ? max_sum
                                                           : rng.uniform(0, max_sum + 1));
        }
      }
      const Selection selection = to_selection(row);
      for (int switches = 0; switches < 8; ++switches) {
        Parameters p = window_parameters();
        p.disparity_range = range;
        p.left_right_check = (switches & 1) != 0;
        p.uniqueness_check = (switches & 2) != 0;
        p.subpixel = (switches & 4) != 0;
        p.disp12MaxDiff = switches;
        const Case c{p, 22, "sums up to " + std::to_string(max_sum)};
        cv::Mat1b kept(1, kWidth + simd::kBorder), expected_kept;
        check(selection, p, cv::Range::all(), expected_kept);
        simd::check(row, p, kept[0]);
        ASSERT_TRUE(same("check", expected_kept, kept.colRange(0, kWidth), c));
        cv::Mat1w disparity(1, kWidth + simd::kBorder), expected;
        subpixel(selection, expected_kept, p, cv::Range::all(), expected);
        simd::subpixel(row, kept[0], p, disparity[0]);
        ASSERT_TRUE(same("subpixel", expected, disparity.colRange(0, kWidth), c));
      }
    }
  }
}

TEST_P(SimdStages, Speckle) {
  cv::RNG rng(23);
  simd::SpeckleFilter filter;
  for (const cv::Size size : {cv::Size(1, 1), {1, 60}, {63, 50}, {64, 30}, {65, 30}, {200, 90}}) {
    for (const int levels : {1, 2, 5, 200}) {
      for (const double holes : {0.0, 0.1, 0.4, 0.6}) {
        cv::Mat1w disparity(size, kNoDisparity);
        for (auto& value : disparity) {
          if (rng.uniform(0.0, 1.0) < holes) continue;
          value = static_cast<std::uint16_t>(rng.uniform(0, levels) * 33 + rng.uniform(0, 3));
        }
        for (const int min_size : {0, 1, 2, 7, 60, 400}) {
          Parameters p = window_parameters();
          p.speckle_size = min_size;
          p.speckle_range = min_size % 3;
          cv::Mat1w expected = disparity.clone();
          speckle(p, expected);
          simd::DisparityImage actual;
          actual.create(size);
          disparity.copyTo(actual.image);
          filter.apply(p, actual);
          ASSERT_TRUE(
              same("speckle", expected, actual.image, {p, 23, std::to_string(levels) + " levels"}));
        }
      }
    }
  }
}

TEST(SimdLayout, CensusBorderFitsTheLargestWindow) {
  Parameters p = window_parameters();
  for (p.census_window_size = 5; validate(p); p.census_window_size += 2) {
    EXPECT_LE(p.census_window_size / 2, simd::max_census_radius());
  }
  EXPECT_EQ(p.census_window_size / 2, simd::max_census_radius() + 1);
}

TEST(SimdLayout, BordersAreFilledWhenTheSizeChanges) {
  simd::DisparityImage image;
  for (const cv::Size size : {cv::Size(5, 3), cv::Size(9, 2)}) {
    image.create(size);
    image.image = std::uint16_t{7};
    image.create(size);
    EXPECT_EQ(cv::countNonZero(image.image == 7), size.area()) << "contents are kept";
    EXPECT_EQ(cv::countNonZero(image.all == kNoDisparity), 2 * simd::kBorder * size.height);
  }
}

TEST(StageTimer, AddsEachLapToItsStage) {
  StageTimes ms{};
  simd::StageTimer timer(ms);
  for (int i = 0; i < 2; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    timer.lap(Stage::kCensus);
    timer.lap(Stage::kMatch);
  }
  EXPECT_GE(ms[static_cast<std::size_t>(Stage::kCensus)], 2);
  EXPECT_GT(ms[static_cast<std::size_t>(Stage::kMatch)], 0);
  EXPECT_EQ(ms[static_cast<std::size_t>(Stage::kRectify)], 0);
}

TEST(StageTimer, AddsNothingIfDisabled) {
  StageTimes ms{};
  simd::StageTimer timer(ms, false);
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  timer.lap(Stage::kCensus);
  EXPECT_EQ(timer.restart(), 0);
  EXPECT_EQ(ms, StageTimes{});
}

INSTANTIATE_TEST_SUITE_P(Targets, SimdStages, ::testing::ValuesIn(simd_targets()), target_name);

}  // namespace
}  // namespace fpga_stereo::test
