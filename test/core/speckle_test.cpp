#include <gtest/gtest.h>

#include <opencv2/calib3d.hpp>

#include "core/reference_pipeline.hpp"
#include "support/compare.hpp"
#include "support/data_test.hpp"
#include "support/images.hpp"
#include "support/naive.hpp"

namespace fpga_stereo::test {
namespace {

constexpr std::uint16_t kNone = kNoDisparity;

Parameters speckle(int size, int range = 1) {
  Parameters p = window_parameters();
  p.speckle_size = size;
  p.speckle_range = range;
  return p;
}

cv::Mat1w speckle_of(const cv::Mat1w& disparity, const Parameters& p) {
  cv::Mat1w out = disparity.clone();
  speckle(p, out);
  return out;
}

/// Runs OpenCV's filter, whose size parameter is the largest area that is dropped.
cv::Mat1w filter_speckles(const cv::Mat1w& disparity, const Parameters& p) {
  cv::Mat1s signed_values;
  disparity.convertTo(signed_values, CV_16S);
  signed_values.setTo(-1, disparity == kNone);
  cv::filterSpeckles(signed_values, -1, p.speckle_size - 1, p.speckle_range * kDisparityScale);
  cv::Mat1w out;
  signed_values.convertTo(out, CV_16U);
  out.setTo(kNone, signed_values == -1);
  return out;
}

/// Returns random disparities on `levels` levels, with holes: regions of many sizes.
cv::Mat1w random_disparity(cv::Size size, int levels, double holes, unsigned seed) {
  cv::RNG rng(seed);
  cv::Mat1w out(size);
  for (auto& value : out) {
    value = rng.uniform(0.0, 1.0) < holes
                ? kNone
                : static_cast<std::uint16_t>(rng.uniform(0, levels) * 33 + rng.uniform(0, 3));
  }
  return out;
}

TEST(Speckle, DropsRegionsBelowTheSize) {
  cv::Mat1w image(5, 9, kNone);
  image(cv::Rect(0, 0, 3, 2)) = 100;      // 6 pixels
  image(cv::Rect(5, 1, 1, 5 - 1)) = 200;  // 4 pixels
  cv::Mat1w expected = image.clone();
  expected(cv::Rect(5, 1, 1, 4)) = kNone;
  EXPECT_TRUE(same("speckle", image, speckle_of(image, speckle(4))));
  EXPECT_TRUE(same("speckle", expected, speckle_of(image, speckle(5))));
  EXPECT_TRUE(same("speckle", expected, speckle_of(image, speckle(6))));
  EXPECT_TRUE(same("speckle", cv::Mat1w(5, 9, kNone), speckle_of(image, speckle(7))));
}

TEST(Speckle, DiagonalsDoNotConnect) {
  cv::Mat1w image(6, 6, kNone);
  for (int i = 0; i < 6; ++i) image(i, i) = 64;
  EXPECT_EQ(cv::countNonZero(speckle_of(image, speckle(2)) != kNone), 0);
  EXPECT_EQ(cv::countNonZero(speckle_of(image, speckle(1)) != kNone), 6);
}

TEST(Speckle, RangeIsInclusive) {
  for (const int range : {0, 1, 2, 31}) {
    const int step = 32 * range;
    const cv::Mat1w at = (cv::Mat1w(1, 3) << 1000, 1000 + step, 1000);
    const cv::Mat1w above = (cv::Mat1w(1, 3) << 1000, 1001 + step, 1000);
    EXPECT_TRUE(same("speckle", at, speckle_of(at, speckle(3, range)))) << range;
    EXPECT_EQ(cv::countNonZero(speckle_of(above, speckle(2, range)) != kNone), 0) << range;
  }
}

TEST(Speckle, SwitchedOff) {
  const cv::Mat1w image = random_disparity({20, 20}, 9, 0.3, 1);
  EXPECT_TRUE(same("speckle", image, speckle_of(image, speckle(0))));
  EXPECT_TRUE(same("speckle", image, speckle_of(image, speckle(1))))
      << "every region has one pixel";
}

// In a column of 30 pixels, row y sees the rows up to y + 24, so row 1 is the first to see 26
// pixels.
TEST(Speckle, LookAheadByHand) {
  const cv::Mat1w column(30, 1, std::uint16_t{320});
  const cv::Mat1w kept = speckle_of(column, speckle(26));
  EXPECT_EQ(kept(0, 0), kNone);
  EXPECT_EQ(cv::countNonZero(kept.rowRange(1, 30) == 320), 29);
  EXPECT_EQ(cv::countNonZero(speckle_of(column, speckle(25)) == 320), 30);
  const cv::Mat1w large = speckle_of(column, speckle(30));
  EXPECT_EQ(cv::countNonZero(large.rowRange(0, 5) == kNone), 5);
  EXPECT_EQ(cv::countNonZero(large.rowRange(5, 30) == 320), 25);
}

// If two arms meet further down than the look-ahead, their upper rows see two regions.
TEST(Speckle, ArmsOfAConcaveRegion) {
  const auto two_arms = [](int height) {
    cv::Mat1w image(height, 5, kNone);
    image.col(0) = 64;
    image.col(4) = 64;
    image.row(height - 1) = 64;
    return image;
  };
  // 25 rows: row 0 sees the bridge in row 24, all 53 pixels.
  EXPECT_TRUE(same("speckle", two_arms(25), speckle_of(two_arms(25), speckle(53))));
  // 26 rows: row 0 sees two arms of 25 pixels only.
  cv::Mat1w expected = two_arms(26);
  expected.row(0) = kNone;
  EXPECT_TRUE(same("speckle", expected, speckle_of(two_arms(26), speckle(26))));
  EXPECT_TRUE(same("speckle", two_arms(26), speckle_of(two_arms(26), speckle(25))));
}

TEST(Speckle, EqualsTheNaiveModel) {
  unsigned seed = 1100;
  for (const cv::Size size : {cv::Size(1, 1), {1, 40}, {40, 1}, {2, 70}, {37, 61}}) {
    for (const int minimum : {1, 2, 9, 40, 300}) {
      for (const double holes : {0.0, 0.2, 0.42}) {
        for (const int levels : {1, 2, 6}) {
          const Parameters p = speckle(minimum);
          const cv::Mat1w image = random_disparity(size, levels, holes, ++seed);
          const cv::Mat1w expected = naive::speckle(image, p);
          ASSERT_TRUE(same("speckle", expected, speckle_of(image, p), {p, seed, "random"}));
          cv::Mat1w part = padded(image, seed);
          speckle(p, part);
          ASSERT_TRUE(same("speckle", expected, part, {p, seed, "padded"}));
        }
      }
    }
  }
}

TEST(Speckle, ChangesNothingAroundASubImage) {
  cv::Mat1w large(20, 30, std::uint16_t{5});
  cv::Mat1w part = large(cv::Rect(8, 6, 9, 7));
  part = kNone;
  part(3, 3) = 77;
  cv::Mat1w expected = large.clone();
  expected(6 + 3, 8 + 3) = kNone;
  speckle(speckle(2), part);
  EXPECT_TRUE(same("speckle", expected, large));
}

// Every row of a region of less than 24 rows sees all of it.
TEST(Speckle, EqualsFilterSpecklesOnRegionsOfFewRows) {
  unsigned seed = 1200;
  for (const int minimum : {2, 5, 30, 400}) {
    for (const double holes : {0.05, 0.3, 0.42}) {
      for (const int levels : {1, 3}) {
        cv::Mat1w image = random_disparity({80, 96}, levels, holes, ++seed);
        for (int y = 23; y < image.rows; y += 24) image.row(y) = kNone;
        const Parameters p = speckle(minimum);
        ASSERT_TRUE(
            same("speckle", filter_speckles(image, p), speckle_of(image, p), {p, seed, "24 rows"}));
      }
    }
  }
}

using SpeckleData = DataTest;

/// Expects that the filter and OpenCV's agree on 99 % of the pixels of a pair's disparity image.
void expect_agreement(const cv::Mat1b& left, const cv::Mat1b& right,
                      const StereoRectification& rectification, Parameters p) {
  ReferencePipeline pipeline;
  const cv::Mat1w in = pipeline.process(left, right, rectification, p, 1).refined;
  for (const int minimum : {Parameters().speckle_size, 400}) {
    p.speckle_size = minimum;
    SCOPED_TRACE(::testing::Message() << "speckle_size " << minimum);
    const cv::Mat1w ours = speckle_of(in, p);
    const cv::Mat1w theirs = filter_speckles(in, p);
    const double agree = cv::countNonZero(ours == theirs) / static_cast<double>(in.total());
    EXPECT_GE(agree, 0.99);
    EXPECT_GT(cv::countNonZero(theirs != in), 50) << "OpenCV drops too little for a comparison";
    EXPECT_EQ(cv::countNonZero((ours != kNone) & (theirs == kNone)), 0)
        << "the limited look-ahead may only drop more";
  }
}

TEST_F(SpeckleData, AgreesWithFilterSpecklesOnMiddlebury) {
  for (const std::string& name : middlebury_names()) {
    SCOPED_TRACE(name);
    const MiddleburyPair pair = middlebury_pair(name);
    StereoGeometry geometry;
    geometry.image_size = pair.left.size();
    Parameters p = window_parameters();
    p.disparity_range = pair.disparity_range;
    expect_agreement(pair.left, pair.right, identity_rectification(geometry, 0), p);
  }
}

TEST_F(SpeckleData, EqualsTheNaiveModel) {
  const MiddleburyPair pair = middlebury_pair("tsukuba");
  StereoGeometry geometry;
  geometry.image_size = pair.left.size();
  Parameters p = window_parameters();
  p.disparity_range = pair.disparity_range;
  p.speckle_size = 1000;  // the look-ahead matters most
  ReferencePipeline pipeline;
  const Taps& taps =
      pipeline.process(pair.left, pair.right, identity_rectification(geometry, 0), p, 1);
  EXPECT_TRUE(same("speckle", naive::speckle(taps.refined, p), taps.disparity, {p, 0, "tsukuba"}));
  EXPECT_NE(cv::countNonZero(filter_speckles(taps.refined, p) != taps.disparity), 0)
      << "the look-ahead makes no difference here";
}

TEST_F(SpeckleData, AgreesWithFilterSpecklesOnTheSequence) {
  const CalibrationPair cameras = euroc_calibration();
  const auto rectification = make_stereo_rectification(cameras.left, cameras.right, 0);
  ASSERT_TRUE(rectification) << rectification.error().message;
  const ImagePair pair = euroc_pair(0);
  expect_agreement(pair.left, pair.right, *rectification, window_parameters());
}

}  // namespace
}  // namespace fpga_stereo::test
