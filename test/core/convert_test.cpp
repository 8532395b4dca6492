#include "fpga_stereo/core/convert.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/stages.hpp"
#include "support/compare.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

// fx baseline = 48 px m, so the depth is 48 / d metres.
const Reprojection kCamera{400, 410, 100, 60, 0.12, 0};

cv::Mat1w row(std::initializer_list<std::uint16_t> values) {
  cv::Mat1w image(1, static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), image.begin());
  return image;
}

Reprojection with_offset(double offset) {
  Reprojection r = kCamera;
  r.offset = offset;
  return r;
}

TEST(Reprojection, OffsetFromMinDisparityAndPrincipalPoints) {
  StereoGeometry g;
  g.fx = 400;
  g.fy = 410;
  g.cx = 320;
  g.cx_right = 322.5;
  g.cy = 240;
  g.baseline = 0.1;
  const Reprojection r = make_reprojection(g, 8);
  EXPECT_EQ(r.fx, 400);
  EXPECT_EQ(r.fy, 410);
  EXPECT_EQ(r.cx, 320);
  EXPECT_EQ(r.cy, 240);
  EXPECT_EQ(r.baseline, 0.1);
  EXPECT_EQ(r.offset, 10.5);
}

TEST(ToFloat, EveryValue) {
  cv::Mat1w all(256, 256);
  for (int i = 0; i < 65536; ++i) all(i / 256, i % 256) = static_cast<std::uint16_t>(i);
  for (const double offset : {0.0, -8.0, 2.25}) {
    cv::Mat1f out;
    to_float(all, offset, -1000, out);
    int wrong = 0;
    for (int i = 0; i < 65535; ++i) {
      if (static_cast<double>(out(i / 256, i % 256)) != i / 32.0 + offset) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << offset;
    EXPECT_EQ(out(255, 255), -1000) << "invalid pixels get no offset";
  }
}

TEST(ToFloat, MarksInvalidPixelsWithTheGivenValue) {
  cv::Mat1f out;
  to_float(row({0, 0xFFFF, 0xFFFE}), 0, std::numeric_limits<float>::quiet_NaN(), out);
  EXPECT_EQ(out(0, 0), 0);
  EXPECT_TRUE(std::isnan(out(0, 1)));
  EXPECT_EQ(out(0, 2), 2047.9375F);
}

TEST(ToDepth, HasNoDepthWithoutBaseline) {
  cv::Mat1f metres;
  to_depth(cv::Mat1w(1, 1, std::uint16_t{32}), Reprojection{}, metres);
  EXPECT_TRUE(std::isnan(metres(0, 0)));
}

TEST(ToDepth, MetresByHand) {
  cv::Mat1f out;
  to_depth(row({32, 16 * 32, 1, 0, 0xFFFF}), kCamera, out);
  EXPECT_FLOAT_EQ(out(0, 0), 48);
  EXPECT_FLOAT_EQ(out(0, 1), 3);
  EXPECT_FLOAT_EQ(out(0, 2), 1536);
  EXPECT_TRUE(std::isnan(out(0, 3))) << "infinitely far";
  EXPECT_TRUE(std::isnan(out(0, 4)));
}

TEST(ToDepth, OffsetMovesTheDisparity) {
  cv::Mat1f out;
  to_depth(row({0, 64, 128, 0xFFFF}), with_offset(4), out);
  EXPECT_FLOAT_EQ(out(0, 0), 12);
  EXPECT_FLOAT_EQ(out(0, 1), 8);
  EXPECT_TRUE(std::isnan(out(0, 3)));
  to_depth(row({0, 64, 128, 160}), with_offset(-4), out);
  EXPECT_TRUE(std::isnan(out(0, 0))) << "behind the camera";
  EXPECT_TRUE(std::isnan(out(0, 1)));
  EXPECT_TRUE(std::isnan(out(0, 2))) << "infinitely far";
  EXPECT_FLOAT_EQ(out(0, 3), 48);
}

TEST(ToDepth, MillimetresByHand) {
  cv::Mat1w out;
  to_depth(row({32, 16 * 32, 7 * 32, 0, 0xFFFF, 1}), kCamera, out);
  EXPECT_EQ(out(0, 0), 48000);
  EXPECT_EQ(out(0, 1), 3000);
  EXPECT_EQ(out(0, 2), 6857) << "6857.14 is rounded";
  EXPECT_EQ(out(0, 3), 0);
  EXPECT_EQ(out(0, 4), 0);
  EXPECT_EQ(out(0, 5), 0) << "1536 m do not fit";
  to_depth(row({0, 160}), with_offset(-4), out);
  EXPECT_EQ(out(0, 0), 0) << "behind the camera";
  EXPECT_EQ(out(0, 1), 48000);
}

TEST(ToDepth, MillimetresUpTo65535) {
  Reprojection r = kCamera;
  r.baseline = 0.0655354 * 1000 / r.fx;  // 65.5354 m at 1 px
  cv::Mat1w out;
  to_depth(row({32}), r, out);
  EXPECT_EQ(out(0, 0), 65535) << "65535.4 is rounded to 65535";
  r.baseline = 0.0655356 * 1000 / r.fx;
  to_depth(row({32}), r, out);
  EXPECT_EQ(out(0, 0), 0) << "65535.6 is rounded to 65536, which does not fit";
}

TEST(ToColor, InvalidIsBlackNearIsRedFarIsBlue) {
  cv::Mat3b out;
  to_color(row({0xFFFF, 8 * 32, 55 * 32, 0}), 64, out);
  EXPECT_EQ(out(0, 0), cv::Vec3b(0, 0, 0));
  EXPECT_GT(out(0, 1)[0], out(0, 1)[2]) << "far: more blue than red";
  EXPECT_GT(out(0, 2)[2], out(0, 2)[0]) << "near: more red than blue";
  EXPECT_NE(out(0, 3), cv::Vec3b(0, 0, 0)) << "disparity 0 is valid";
}

TEST(ToColor, SpansTheSearchRange) {
  cv::Mat3b small, large;
  to_color(row({0, 15 * 32}), 16, small);
  to_color(row({0, 255 * 32}), 256, large);
  EXPECT_TRUE(same("to_color", small, large));
  EXPECT_NE(small(0, 0), small(0, 1));
}

TEST(Convert, PitchAboveWidthAndReuseOfTheOutput) {
  const cv::Mat1w image = row({64, 0xFFFF, 320, 1});
  const cv::Mat1w part = padded(image, 9);
  cv::Mat1f a, b(50, 50);
  to_float(image, 1, -1, a);
  to_float(part, 1, -1, b);
  EXPECT_TRUE(same("to_float", a, b));
  cv::Mat1w c, d(1, 9);
  to_depth(image, kCamera, c);
  to_depth(part, kCamera, d);
  EXPECT_TRUE(same("to_depth", c, d));
  cv::Mat3b e, f(2, 2);
  to_color(image, 16, e);
  to_color(part, 16, f);
  EXPECT_TRUE(same("to_color", e, f));
}

}  // namespace
}  // namespace fpga_stereo::test
