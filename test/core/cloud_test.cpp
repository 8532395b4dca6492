#include "fpga_stereo/core/cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "core/stages.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {
namespace {

// fx baseline = 48 px m, fy = 2 fx.
const Reprojection kCamera{400, 800, 2, 1, 0.12, 0};

CloudLayout layout(PointColor color, bool is_padded, bool is_organized, int decimation = 1) {
  return {color, is_padded, is_organized, decimation};
}

float float_at(const Cloud& cloud, const CloudLayout& l, int point, int offset) {
  float value = 0;
  std::memcpy(&value, cloud.data.data() + point * l.point_step() + offset, sizeof value);
  return value;
}

/// Returns 4 x 3 pixels with a disparity of 4 px, except (1, 0), which has none.
cv::Mat1w small_disparity() {
  cv::Mat1w disparity(3, 4, std::uint16_t{4 * 32});
  disparity(0, 1) = kNoDisparity;
  return disparity;
}

/// Returns disparities of up to 255 px, and pixels without one.
cv::Mat1w random_disparity(cv::Size size) {
  cv::RNG rng(5);
  cv::Mat1w disparity(size);
  for (auto& value : disparity) {
    value =
        rng.uniform(0, 4) == 0 ? kNoDisparity : static_cast<std::uint16_t>(rng.uniform(0, 8161));
  }
  return disparity;
}

TEST(CloudLayout, Sizes) {
  EXPECT_EQ(layout(PointColor::kRgb, true, true).point_step(), 32);
  EXPECT_EQ(layout(PointColor::kMono, true, true).point_step(), 32);
  EXPECT_EQ(layout(PointColor::kNone, true, true).point_step(), 16);
  EXPECT_EQ(layout(PointColor::kRgb, false, true).point_step(), 16);
  EXPECT_EQ(layout(PointColor::kMono, false, true).point_step(), 16);
  EXPECT_EQ(layout(PointColor::kNone, false, true).point_step(), 12);
  EXPECT_EQ(layout(PointColor::kRgb, true, true).color_offset(), 16);
  EXPECT_EQ(layout(PointColor::kRgb, false, true).color_offset(), 12);
}

TEST(Cloud, OrganizedByHand) {
  for (const bool is_padded : {true, false}) {
    const CloudLayout l = layout(PointColor::kNone, is_padded, true);
    Cloud cloud;
    to_cloud(small_disparity(), kCamera, cv::Mat1b(3, 4, std::uint8_t{0}), l, cloud);
    EXPECT_EQ(cloud.width, 4);
    EXPECT_EQ(cloud.height, 3);
    ASSERT_EQ(cloud.data.size(), 12U * l.point_step());
    // Pixel (3, 2), with baseline T: X = T (3 - 2) / 4, Y = T fx / fy (2 - 1) / 4, Z = 48 / 4.
    EXPECT_FLOAT_EQ(float_at(cloud, l, 11, 0), 0.03F);
    EXPECT_FLOAT_EQ(float_at(cloud, l, 11, 4), 0.015F);
    EXPECT_FLOAT_EQ(float_at(cloud, l, 11, 8), 12);
    // Pixel (0, 0) lies to the left of the optical axis and above it.
    EXPECT_FLOAT_EQ(float_at(cloud, l, 0, 0), -0.06F);
    EXPECT_FLOAT_EQ(float_at(cloud, l, 0, 4), -0.015F);
    for (const int offset : {0, 4, 8}) {
      EXPECT_TRUE(std::isnan(float_at(cloud, l, 1, offset)));
    }
  }
}

TEST(Cloud, ValidPointsOnly) {
  const CloudLayout l = layout(PointColor::kMono, true, false);
  cv::Mat1b grey(3, 4);
  for (int i = 0; i < 12; ++i) grey(i / 4, i % 4) = static_cast<std::uint8_t>(i);
  Cloud cloud;
  to_cloud(small_disparity(), kCamera, grey, l, cloud);
  EXPECT_EQ(cloud.width, 11);
  EXPECT_EQ(cloud.height, 1);
  ASSERT_EQ(cloud.data.size(), 11U * 32);
  EXPECT_EQ(float_at(cloud, l, 0, 16), 0);
  EXPECT_EQ(float_at(cloud, l, 1, 16), 2) << "the pixel after the one without disparity";
  EXPECT_EQ(float_at(cloud, l, 10, 16), 11);

  to_cloud(cv::Mat1w(3, 4, kNoDisparity), kCamera, grey, l, cloud);
  EXPECT_EQ(cloud.width, 0);
  EXPECT_TRUE(cloud.data.empty());
}

TEST(Cloud, ColorBytesAreBlueGreenRed) {
  const CloudLayout l = layout(PointColor::kRgb, false, true);
  const cv::Mat3b color(3, 4, cv::Vec3b(10, 20, 30));
  Cloud cloud;
  to_cloud(small_disparity(), kCamera, color, l, cloud);
  for (const int point : {0, 1}) {  // with and without a position
    const std::uint8_t* bytes = cloud.data.data() + point * l.point_step() + 12;
    EXPECT_EQ(std::vector<int>(bytes, bytes + 4), (std::vector<int>{10, 20, 30, 0}));
  }
  to_cloud(small_disparity(), kCamera, cv::Mat1b(3, 4, std::uint8_t{99}), l, cloud);
  const std::uint8_t* grey = cloud.data.data() + 12;
  EXPECT_EQ(std::vector<int>(grey, grey + 4), (std::vector<int>{99, 99, 99, 0}));
}

TEST(Cloud, IntensityOfAColorImage) {
  const CloudLayout l = layout(PointColor::kMono, true, true);
  Cloud cloud;
  to_cloud(small_disparity(), kCamera, cv::Mat3b(3, 4, cv::Vec3b(255, 0, 0)), l, cloud);
  EXPECT_NEAR(float_at(cloud, l, 0, 16), 0.114 * 255, 1e-3);
  to_cloud(small_disparity(), kCamera, cv::Mat3b(3, 4, cv::Vec3b(255, 255, 255)), l, cloud);
  EXPECT_NEAR(float_at(cloud, l, 0, 16), 255, 1e-3);
}

TEST(Cloud, PaddingIsZeroEvenIfMemoryIsReused) {
  const CloudLayout l = layout(PointColor::kRgb, true, true);
  Cloud cloud;
  cloud.data.assign(5000, 0xAB);
  to_cloud(small_disparity(), kCamera, cv::Mat1b(3, 4, std::uint8_t{7}), l, cloud);
  int set = 0;
  for (int point = 0; point < 12; ++point) {
    for (const int byte : {12, 13, 14, 15, 19, 20, 25, 31}) {
      set += cloud.data[static_cast<std::size_t>(point * 32 + byte)] != 0 ? 1 : 0;
    }
  }
  EXPECT_EQ(set, 0);
}

TEST(Cloud, Decimation) {
  cv::Mat1w disparity(5, 7, std::uint16_t{4 * 32});
  cv::Mat1b grey(5, 7);
  for (int y = 0; y < 5; ++y) {
    for (int x = 0; x < 7; ++x) grey(y, x) = static_cast<std::uint8_t>(10 * y + x);
  }
  const CloudLayout l = layout(PointColor::kMono, true, true, 3);
  Cloud cloud;
  to_cloud(padded(disparity, 1), kCamera, padded(grey, 2), l, cloud);
  EXPECT_EQ(cloud.width, 3);
  EXPECT_EQ(cloud.height, 2);
  const int expected[] = {0, 3, 6, 30, 33, 36};
  for (int i = 0; i < 6; ++i) EXPECT_EQ(float_at(cloud, l, i, 16), expected[i]);
  EXPECT_FLOAT_EQ(float_at(cloud, l, 1, 0), 0.03F) << "the position is that of column 3";
}

TEST(Cloud, OffsetDecidesWhichPointsLieInFrontOfTheCamera) {
  Reprojection r = kCamera;
  r.offset = -4;
  const CloudLayout l = layout(PointColor::kNone, false, false);
  cv::Mat1w disparity = (cv::Mat1w(1, 4) << 3 * 32, 4 * 32, 6 * 32, 0xFFFF);
  Cloud cloud;
  to_cloud(disparity, r, cv::Mat1b(1, 4, std::uint8_t{0}), l, cloud);
  ASSERT_EQ(cloud.width, 1);
  EXPECT_FLOAT_EQ(float_at(cloud, l, 0, 8), 24);
}

// The principal points differ, so the floats are rounded.
TEST(Cloud, OfTheFloatsHasTheBytesOfThePipelinesCloud) {
  const cv::Size size(13, 7);
  const cv::Mat1w disparity = random_disparity(size);
  Reprojection r = kCamera;
  for (const double offset : {0.0, 8.0, -20.123456789}) {
    r.offset = offset;
    const auto min = static_cast<float>(offset);
    cv::Mat1f floats;
    to_float(disparity, r.offset, min - 1, floats);
    const CloudLayout l = layout(PointColor::kRgb, true, true);
    Cloud expected, cloud;
    to_cloud(disparity, r, cv::Mat(random_image(size, 6)), l, expected);
    Reprojection without_offset = r;
    without_offset.offset = 0;
    to_cloud(padded(floats, 3), min, without_offset, cv::Mat(random_image(size, 6)), l, cloud);
    EXPECT_EQ(cloud.width, expected.width);
    EXPECT_EQ(cloud.height, expected.height);
    EXPECT_EQ(cloud.data, expected.data) << offset;
  }
}

TEST(Cloud, OfFloatsHasNoPointWithoutAPositiveDisparityInTheRange) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const cv::Mat1f disparity = (cv::Mat1f(1, 10) << 4, 3.5F, 2.9375F, 2, std::nanf(""), kInfinity,
                               -kInfinity, 0, -4, 1e-12F);
  const CloudLayout l = layout(PointColor::kNone, false, true);
  const auto valid_points = [&](float min_disparity) {
    Cloud cloud;
    to_cloud(disparity, min_disparity, kCamera, cv::Mat(), l, cloud);
    std::vector<int> valid;
    for (int point = 0; point < 10; ++point) {
      if (!std::isnan(float_at(cloud, l, point, 8))) valid.push_back(point);
    }
    return valid;
  };
  EXPECT_EQ(valid_points(3), (std::vector<int>{0, 1})) << "3 - 1/16 is below the range";
  EXPECT_EQ(valid_points(0), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(valid_points(-16), (std::vector<int>{0, 1, 2, 3})) << "behind the camera";
}

/// Compares every pixel with the formula.
TEST(Cloud, EveryLayoutAndKindOfImage) {
  const cv::Size size(13, 7);
  const cv::Mat1w disparity = random_disparity(size);
  Reprojection r = kCamera;
  r.offset = -20.5;
  for (const cv::Mat& image :
       {cv::Mat(random_image(size, 6)), cv::Mat(random_color_image(size, 7))}) {
    for (const PointColor color : {PointColor::kRgb, PointColor::kMono, PointColor::kNone}) {
      for (int kind = 0; kind < 4; ++kind) {
        const CloudLayout l = layout(color, (kind & 1) != 0, (kind & 2) != 0, 1 + kind % 3);
        Cloud cloud;
        to_cloud(disparity, r, image, l, cloud);
        int point = 0;
        for (int y = 0; y < size.height; y += l.decimation) {
          for (int x = 0; x < size.width; x += l.decimation) {
            const double d = disparity(y, x) / 32.0 - 20.5;
            const bool valid = disparity(y, x) != kNoDisparity && d > 0;
            if (!valid && !l.organized) continue;
            if (valid) {
              ASSERT_EQ(float_at(cloud, l, point, 0), static_cast<float>((x - 2) * (0.12 / d)));
              ASSERT_FLOAT_EQ(float_at(cloud, l, point, 4), static_cast<float>((y - 1) * 0.06 / d));
              ASSERT_EQ(float_at(cloud, l, point, 8), static_cast<float>(400 * (0.12 / d)));
            } else {
              ASSERT_TRUE(std::isnan(float_at(cloud, l, point, 8)));
            }
            if (color == PointColor::kRgb) {
              const std::uint8_t* pixel = image.ptr(y, x);
              const std::uint8_t* bytes =
                  cloud.data.data() + point * l.point_step() + l.color_offset();
              ASSERT_EQ(bytes[0], pixel[0]);
              ASSERT_EQ(bytes[1], image.channels() == 3 ? pixel[1] : pixel[0]);
              ASSERT_EQ(bytes[2], image.channels() == 3 ? pixel[2] : pixel[0]);
              ASSERT_EQ(bytes[3], 0);
            }
            ++point;
          }
        }
        ASSERT_EQ(static_cast<int>(cloud.data.size()), point * l.point_step());
      }
    }
  }
}

}  // namespace
}  // namespace fpga_stereo::test
