// Between messages and core. Plain functions: they need no node and no master.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <stereo_msgs/DisparityImage.h>

#include <opencv2/core.hpp>
#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/cloud.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// The same fields under the names of core.
CameraCalibration to_calibration(const sensor_msgs::CameraInfo& info);

/// Any encoding that cv_bridge turns into grey (mono8, mono16, bgr8, rgb8, bgra8, rgba8, bayer_*)
/// as 8UC1. Shares the data of a mono8 message. `camera` names the image in the refusal.
Result<cv::Mat> to_grey(const sensor_msgs::ImageConstPtr& image, const std::string& camera);

/// The same in colour: 8UC3 bgr, or 8UC1 where the camera sees grey.
Result<cv::Mat> to_bgr(const sensor_msgs::ImageConstPtr& image, const std::string& camera);

/// Makes `message` an image of this size and type (8UC1: mono8, 8UC3: bgr8, 16UC1, 32FC1) and
/// returns its pixels, which are in the memory of the message, to be written.
cv::Mat image_in(sensor_msgs::Image& message, const std_msgs::Header& header, cv::Size size,
                 int type);

/// A copy of an 8UC1 (mono8), 8UC3 (bgr8), 16UC1 or 32FC1 image as a message.
sensor_msgs::ImagePtr to_image(const cv::Mat& image, const std_msgs::Header& header);

/// Fields as stereo_image_proc fills them; where they differ: valid_window is computed from the
/// size of the image, delta_d is our step, the offset of the principal points is subtracted once.
/// Of a message that is used again all is written.
void to_disparity_image(const cv::Mat1w& disparity, const StereoGeometry& geometry,
                        const Parameters& parameters, const std_msgs::Header& header,
                        stereo_msgs::DisparityImage& message);

/// Fields x, y, z and, by layout, rgb or intensity. Of a message that is used again all is written.
void to_point_cloud2(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
                     const CloudLayout& layout, const std_msgs::Header& header,
                     sensor_msgs::PointCloud2& message);

}  // namespace fpga_stereo
