// Compares disparities and clouds in messages.
#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <stereo_msgs/DisparityImage.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace fpga_stereo::test {

/// Returns the float at this byte.
float float_at(const std::vector<std::uint8_t>& data, std::size_t offset);

/// Expects core's disparity plus `offset` in every pixel of the message, and the marker in invalid
/// pixels.
void expect_disparity(const stereo_msgs::DisparityImage& message, const cv::Mat1w& expected,
                      double offset);

/// Expects that a tenth of the pixels have a disparity in both messages, and that nine of ten of
/// these differ by at most 1 px.
void expect_close_disparities(const stereo_msgs::DisparityImage& ours,
                              const stereo_msgs::DisparityImage& theirs);

/// Expects clouds with the same fields, of points of 32 bytes.
void expect_same_fields(const sensor_msgs::PointCloud2& ours,
                        const sensor_msgs::PointCloud2& theirs);

/// Expects equal clouds of `disparity`, byte for byte except for the last bits of the coordinates,
/// and except for what this project intends to do otherwise than stereo_image_proc.
void expect_same_cloud(const sensor_msgs::PointCloud2& ours, const sensor_msgs::PointCloud2& theirs,
                       const stereo_msgs::DisparityImage& disparity);

}  // namespace fpga_stereo::test
