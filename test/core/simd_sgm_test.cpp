// Every SIMD stage of semi-global matching against its scalar twin, on every target of this
// machine: on images, and with values that no image gives.
#include <gtest/gtest.h>

#include "core/pipeline_rig.hpp"
#include "core/sgm_images.hpp"
#include "core/simd/stages.hpp"
#include "core/simd_rig.hpp"
#include "core/stages.hpp"
#include "support/compare.hpp"

namespace fpga_stereo::test {
namespace {

using SimdSgmStages = SimdStages;

simd::CensusImage census_image(const cv::Mat1b& image) {
  simd::CensusImage result;
  result.create(image.size());
  image.copyTo(result.image);
  return result;
}

/// Census bits and smoothed grey values.
simd::CensusPlanes planes_of(const cv::Mat1b& image, const Parameters& p) {
  simd::CensusPlanes planes = simd_census(image, p);
  simd::smooth_rows(census_image(image), {0, image.rows}, planes);
  return planes;
}

/// Parameters at the ends of their ranges and between.
Parameters random_parameters(cv::RNG& rng) {
  Parameters p;
  for (const ParameterInfo& info : parameter_table()) {
    if (info.name.rfind("cost_", 0) != 0 && info.name.rfind("sgm_", 0) != 0) continue;
    const auto* member = std::get_if<int Parameters::*>(&info.member);
    if (member == nullptr) continue;
    const int min = static_cast<int>(info.min), max = static_cast<int>(info.max);
    const int choice = rng.uniform(0, 4);
    p.*(*member) = choice == 0 ? min : choice == 1 ? max : rng.uniform(min, max + 1);
  }
  p.sgm_build = rng.uniform(0, 2) == 0 ? SgmBuild::kFull : SgmBuild::kSmall;
  EXPECT_TRUE(validate(p));
  return p;
}

TEST_P(SimdSgmStages, SmoothedImages) {
  for (const cv::Size size : {cv::Size(1, 1), {1, 7}, {7, 1}, {2, 2}, {33, 5}, {75, 23}}) {
    for (const NamedImage& input : extreme_images(size, 50)) {
      const Case c{{}, 50, input.name};
      cv::Mat1b rows, binomial;
      smooth_rows(input.image, cv::Range::all(), rows);
      smooth_binomial(input.image, cv::Range::all(), binomial);
      simd::CensusPlanes planes = planes_of(input.image, {});
      for (int y = 0; y < size.height; ++y) {
        ASSERT_TRUE(same("A", rows.row(y), cv::Mat1b(1, size.width, planes.grey(y)), c));
      }
      simd::GuideImage guide;
      guide.create(size);
      simd::smooth_binomial(census_image(input.image), {0, size.height}, guide);
      ASSERT_TRUE(same("G", binomial, guide.image, c));
    }
  }
}

TEST_P(SimdSgmStages, Census) {
  for (const NamedImage& input : extreme_images({75, 23}, 51)) {
    const Parameters p;
    cv::Mat expected;
    census(input.image, p, cv::Range::all(), expected);
    const simd::CensusPlanes planes = simd_census(input.image, p);
    for (int y = 0; y < 23; ++y) {
      for (int x = 0; x < 75; ++x) {
        const int bits = planes.row(y)[x] | planes.row(y)[planes.pitch + x] << 8;
        ASSERT_EQ(expected.ptr<int>(y)[x], bits) << input.name << " at " << x << ", " << y;
      }
    }
  }
}

TEST_P(SimdSgmStages, Cost) {
  cv::RNG rng(52);
  for (const cv::Size size : {cv::Size(1, 1), {1, 6}, {5, 9}, {40, 12}, {97, 8}, {300, 4}}) {
    for (const int range : {8, 28, 32, 64, 68, 128, 256}) {
      Parameters p = random_parameters(rng);
      p.disparity_range = range;
      const cv::Mat1b left = random_image(size, 1), right = random_image(size, 2);
      cv::Mat left_bits, right_bits;
      census(left, p, cv::Range::all(), left_bits);
      census(right, p, cv::Range::all(), right_bits);
      const simd::CensusPlanes left_planes = planes_of(left, p), right_planes = planes_of(right, p);
      const int first = size.height / 3, lanes = simd::lanes_per_pixel(range);
      Cost cost;
      cost.start(left, right, left_bits, right_bits, p, first);
      simd::Cost simd_cost;
      simd_cost.start(left_planes, right_planes, p, first);
      cv::Mat1b row(size.width, lanes);
      for (int y = first; y < size.height; ++y) {
        const cv::Mat1b& expected = cost.next();
        simd_cost.next(row[0]);
        for (int x = 0; x < size.width; ++x) {
          for (int i = 0; i < lanes; ++i) {
            const int d = lanes - 1 - i;
            const int value = d < range ? expected(d, x) : simd::kNoCost;
            ASSERT_EQ(value, row(x, i))
                << "x " << x << ", y " << y << ", d " << d << "; " << Case{p, 52, "cost"};
          }
        }
      }
    }
  }
}

/// Costs of a row as the SIMD stages store them.
cv::Mat1b by_lanes(const cv::Mat1b& costs) {
  const int lanes = simd::lanes_per_pixel(costs.rows);
  cv::Mat1b result(costs.cols, lanes, simd::kNoCost);
  for (int x = 0; x < costs.cols; ++x) {
    for (int d = 0; d < costs.rows; ++d) result(x, lanes - 1 - d) = costs(d, x);
  }
  return result;
}

/// Costs 0 .. 3 of a row, of which one of each pixel is 0.
cv::Mat1b random_costs(int width, int range, cv::RNG& rng) {
  cv::Mat1b costs(range, width);
  const int least = rng.uniform(0, 4);  // 3: everything but one is as bad as can be
  rng.fill(costs, cv::RNG::UNIFORM, least, 4);
  for (int x = 0; x < width; ++x) costs(rng.uniform(0, range), x) = 0;
  return costs;
}

TEST_P(SimdSgmStages, AggregateAndSelect) {
  cv::RNG rng(53);
  for (const cv::Size size : {cv::Size(1, 3), {2, 3}, {15, 5}, {16, 4}, {50, 12}, {130, 6}}) {
    for (const int range : {8, 28, 32, 64, 68, 128, 256}) {
      Parameters p = random_parameters(rng);
      p.disparity_range = range;
      const cv::Mat1b left = random_image(size, static_cast<unsigned>(range));
      const Case c{p, 53, "random costs"};
      Aggregate aggregate;
      aggregate.start(left, p);
      simd::GuideImage guide;
      guide.create(size);
      simd::smooth_binomial(census_image(left), {0, size.height}, guide);
      simd::VerticalPaths vertical;
      vertical.start(size.width, p);
      simd::VerticalCosts rows[2];
      for (simd::VerticalCosts& row : rows) row.create(size.width, range);
      simd::HorizontalPaths horizontal;
      horizontal.start(size.width, p);
      simd::PathSumsBuffer buffer;
      buffer.create(size.width, range);
      const simd::PathSums& sums = buffer.sums();
      simd::SelectionBuffer selected;
      selected.create(size.width, range);
      Selection expected_selection;
      create(expected_selection, size);
      for (int y = 0; y < size.height; ++y) {
        const cv::Mat1b costs = random_costs(size.width, range, rng), lanes = by_lanes(costs);
        const cv::Mat1w& expected = aggregate.next(costs);
        vertical.next(guide.image, y, lanes[0], rows[(y + 1) % 2], rows[y % 2]);
        horizontal.next(guide.image, y, lanes[0], rows[y % 2], sums);
        for (int x = 0; x < size.width; ++x) {
          for (int d = 0; d < range; ++d) {
            ASSERT_EQ(expected(d, x), sums.column(x)[sums.lanes - 1 - d])
                << "x " << x << ", y " << y << ", d " << d << "; " << c;
            ASSERT_LE(expected(d, x), 54);
          }
        }
        select(expected, y, expected_selection);
        simd::select(sums, selected.row());
        for (int x = 0; x < size.width; ++x) {
          const simd::SelectionRow& row = selected.row();
          ASSERT_EQ(expected_selection.winner(y, x), row.winner[x]) << x << "; " << c;
          ASSERT_EQ(expected_selection.right_winner(y, x), row.right_winner[x]) << x << "; " << c;
          ASSERT_EQ(expected_selection.winner_sum(y, x), row.winner_sum[x]) << x << "; " << c;
          ASSERT_EQ(expected_selection.runner_up_sum(y, x), row.runner_up_sum[x]) << x << "; " << c;
        }
      }
    }
  }
}

TEST_P(SimdSgmStages, SelectOnTies) {
  cv::RNG rng(54);
  for (const int levels : {1, 2, 54}) {
    for (const int range : {8, 64, 252, 256}) {
      constexpr int kWidth = 333;
      simd::PathSumsBuffer buffer;
      buffer.create(kWidth, range);
      const simd::PathSums& row = buffer.sums();
      cv::Mat1w sums(range, kWidth);
      rng.fill(sums, cv::RNG::UNIFORM, 55 - levels, 55);
      for (int x = 0; x < kWidth; ++x) {
        for (int d = 0; d < range; ++d) {
          row.column(x)[row.lanes - 1 - d] = static_cast<std::uint8_t>(sums(d, x));
        }
      }
      Selection expected;
      create(expected, {kWidth, 1});
      select(sums, 0, expected);
      simd::SelectionBuffer selected;
      selected.create(kWidth, range);
      simd::select(row, selected.row());
      for (int x = 0; x < kWidth; ++x) {
        ASSERT_EQ(expected.winner(0, x), selected.row().winner[x]) << x << " of " << range;
        ASSERT_EQ(expected.right_winner(0, x), selected.row().right_winner[x])
            << x << " of " << range;
        ASSERT_EQ(expected.runner_up_sum(0, x), selected.row().runner_up_sum[x]) << x;
      }
    }
  }
}

TEST_P(SimdSgmStages, Fit) {
  cv::RNG rng(55);
  for (const cv::Size size : {cv::Size(1, 1), {3, 20}, {31, 13}, {40, 12}, {101, 30}}) {
    for (const int range : {8, 64, 256}) {
      for (const int spread : {1, 3, range}) {  // of winners: near ones count together
        Parameters p;
        p.disparity_range = range;
        p.subpixel = spread != 3 || range != 64;
        const cv::Mat1b left = random_image(size, 3), right = random_image(size, 4);
        cv::Mat left_bits, right_bits;
        census(left, p, cv::Range::all(), left_bits);
        census(right, p, cv::Range::all(), right_bits);
        Selection selection;
        create(selection, size);
        cv::Mat1b kept(size);
        const int lowest = rng.uniform(0, range - spread + 1);
        rng.fill(selection.winner, cv::RNG::UNIFORM, lowest, lowest + spread);
        rng.fill(kept, cv::RNG::UNIFORM, 0, 4);
        kept = cv::min(kept, 1);
        const simd::CensusPlanes left_planes = planes_of(left, p),
                                 right_planes = planes_of(right, p);
        simd::ByteImage winner, keep;
        winner.create(size);
        keep.create(size);
        selection.winner.copyTo(winner.image);
        kept.copyTo(keep.image);
        cv::Mat1w expected;
        fit_subpixel(left_bits, right_bits, selection, kept, p, cv::Range::all(), expected);
        const int first = size.height / 3;
        simd::Fit fit;
        fit.start(left_planes, right_planes, winner, keep, p, first);
        cv::Mat1w row(1, size.width + simd::kBorder);
        for (int y = first; y < size.height; ++y) {
          fit.next(row[0]);
          ASSERT_TRUE(same("fit", expected.row(y), row.colRange(0, size.width),
                           {p, 55, "row " + std::to_string(y)}));
        }
      }
    }
  }
}

TEST_P(SimdSgmStages, Medians) {
  cv::RNG rng(56);
  for (const cv::Size size : {cv::Size(1, 1), {1, 9}, {9, 1}, {17, 16}, {65, 20}, {130, 11}}) {
    for (const int levels : {1, 3, 40, 256}) {
      Parameters p;
      p.median_difference = levels == 40 ? 255 : levels == 3 ? 0 : rng.uniform(0, 60);
      cv::Mat1b left(size);
      rng.fill(left, cv::RNG::UNIFORM, 256 - levels, 256);
      cv::Mat1w input(size);
      rng.fill(input, cv::RNG::UNIFORM, 0, 8192);
      for (auto& value : input) {
        if (rng.uniform(0, 5) == 0) value = kNoDisparity;
      }
      const Case c{p, 56, std::to_string(levels) + " grey levels"};
      cv::Mat1w expected;
      masked_median(left, input, p, cv::Range::all(), expected);
      simd::DisparityImage in, out;
      in.create(size);
      out.create(size);
      input.copyTo(in.image);
      simd::masked_median(census_image(left), in, p, {0, size.height}, out);
      ASSERT_TRUE(same("masked median", expected, out.image, c));
      median(input, cv::Range::all(), expected);
      simd::replicate_columns(in, {0, size.height});
      simd::median(in, {0, size.height}, out);
      ASSERT_TRUE(same("median", expected, out.image, c));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, SimdSgmStages, ::testing::ValuesIn(simd_targets()), target_name);

}  // namespace
}  // namespace fpga_stereo::test
