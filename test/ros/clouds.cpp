#include "ros/clouds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/stages.hpp"

namespace fpga_stereo::test {

using sensor_msgs::PointCloud2;
using stereo_msgs::DisparityImage;

float float_at(const std::vector<std::uint8_t>& data, std::size_t offset) {
  float value = 0;
  std::memcpy(&value, &data[offset], sizeof value);
  return value;
}

void expect_disparity(const DisparityImage& message, const cv::Mat1w& expected, double offset) {
  ASSERT_EQ(message.image.width, static_cast<unsigned>(expected.cols));
  ASSERT_EQ(message.image.height, static_cast<unsigned>(expected.rows));
  int different = 0;
  for (int y = 0; y < expected.rows; ++y) {
    for (int x = 0; x < expected.cols; ++x) {
      const float value = float_at(message.image.data, y * message.image.step + x * 4);
      const float wanted = expected(y, x) == kNoDisparity
                               ? message.min_disparity - 1
                               : static_cast<float>(expected(y, x) / 32.0 + offset);
      if (value != wanted) ++different;
    }
  }
  EXPECT_EQ(different, 0);
}

void expect_close_disparities(const stereo_msgs::DisparityImage& ours,
                              const stereo_msgs::DisparityImage& theirs) {
  const unsigned pixels = ours.image.width * ours.image.height;
  unsigned both = 0, close = 0;
  for (unsigned i = 0; i < pixels; ++i) {
    const float a = float_at(ours.image.data, i * 4);
    const float b = float_at(theirs.image.data, i * 4);
    if (a < 0 || b < 0) continue;
    ++both;
    close += std::abs(a - b) <= 1 ? 1 : 0;
  }
  EXPECT_GT(both, pixels / 10);
  EXPECT_GT(close, both * 9 / 10);
}

void expect_same_fields(const PointCloud2& ours, const PointCloud2& theirs) {
  EXPECT_EQ(ours.header.stamp, theirs.header.stamp);
  EXPECT_EQ(ours.header.frame_id, theirs.header.frame_id);
  EXPECT_EQ(ours.height, theirs.height);
  EXPECT_EQ(ours.width, theirs.width);
  EXPECT_EQ(ours.is_bigendian, theirs.is_bigendian);
  EXPECT_EQ(ours.is_dense, theirs.is_dense);
  EXPECT_EQ(ours.point_step, theirs.point_step);
  EXPECT_EQ(ours.row_step, theirs.row_step);
  ASSERT_EQ(ours.fields.size(), theirs.fields.size());
  for (std::size_t i = 0; i < ours.fields.size(); ++i) {
    EXPECT_EQ(ours.fields[i].name, theirs.fields[i].name);
    EXPECT_EQ(ours.fields[i].offset, theirs.fields[i].offset);
    EXPECT_EQ(ours.fields[i].datatype, theirs.fields[i].datatype);
    EXPECT_EQ(ours.fields[i].count, theirs.fields[i].count);
  }
}

void expect_same_cloud(const PointCloud2& ours, const PointCloud2& theirs,
                       const DisparityImage& disparity) {
  expect_same_fields(ours, theirs);
  ASSERT_EQ(ours.data.size(), theirs.data.size());

  // Intended: the peer takes the smallest value of the image for the marker. If no pixel is
  // invalid, it loses the farthest points; this node does not.
  float smallest = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < disparity.image.data.size(); i += 4) {
    smallest = std::min(smallest, float_at(disparity.image.data, i));
  }
  int valid = 0, wrong = 0, colors = 0;
  for (std::size_t i = 0; i < ours.data.size() / 32; ++i) {
    const float value = float_at(disparity.image.data, i * 4);
    const bool ours_valid = !std::isnan(float_at(ours.data, i * 32 + 8));
    const bool theirs_valid = !std::isnan(float_at(theirs.data, i * 32 + 8));
    if (ours_valid != theirs_valid && !(ours_valid && value == smallest)) ++wrong;
    colors += std::memcmp(&ours.data[i * 32 + 16], &theirs.data[i * 32 + 16], 3) != 0;
    if (!ours_valid || !theirs_valid) continue;
    ++valid;
    for (const std::size_t offset : {0, 4, 8}) {
      const float a = float_at(ours.data, i * 32 + offset);
      const float b = float_at(theirs.data, i * 32 + offset);
      // The peer computes in float, so x and y near the axis have an absolute error.
      wrong += std::abs(a - b) > 1e-5F * std::max(std::abs(b), float_at(theirs.data, i * 32 + 8));
    }
  }
  EXPECT_GT(valid, 1000);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(colors, 0);
}

}  // namespace fpga_stereo::test
