// Converts between ROS messages and the types of core. Needs neither a node nor a master.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>
#include <stereo_msgs/DisparityImage.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/cloud.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Copies all fields that core uses: all but roi.do_rectify and the header. Refuses sizes and
/// lengths that no camera has; `name` names the camera in the error.
Result<CameraCalibration> to_calibration(const sensor_msgs::CameraInfo& info,
                                         const std::string& name);
sensor_msgs::CameraInfo to_camera_info(const CameraCalibration& calibration,
                                       const std_msgs::Header& header);

std_msgs::Header to_header(std::int64_t stamp_ns, const std::string& frame_id);

/// True if the camera sees no colour: mono8 or mono16.
bool is_grey(const sensor_msgs::Image& image);

/// Decodes mono8, mono16, bgr8, rgb8, bgra8, rgba8 and bayer_*8 to 8UC1. The result of a mono8
/// message lies in the memory of the message. Refuses a message whose fields do not describe its
/// data; `camera` names the image in the error.
Result<cv::Mat> to_grey(const sensor_msgs::ImageConstPtr& image, const std::string& camera);

/// Decodes the same encodings to 8UC3 BGR; grey images to 8UC1.
Result<cv::Mat> to_bgr(const sensor_msgs::ImageConstPtr& image, const std::string& camera);

/// Gives `message` the fields of an image of this size and type (8UC1: mono8, 8UC3: bgr8, 16UC1,
/// 32FC1). Returns its pixels, not initialised, in the memory of the message.
cv::Mat image_in(sensor_msgs::Image& message, const std_msgs::Header& header, cv::Size size,
                 int type);

/// Copies an 8UC1 (mono8), 8UC3 (bgr8), 16UC1 or 32FC1 image into a new message.
sensor_msgs::ImagePtr to_image(const cv::Mat& image, const std_msgs::Header& header);

/// Fills `message` as stereo_image_proc does, with three differences: valid_window is computed from
/// the size of the image, delta_d is the step of this pipeline, and the difference of the principal
/// points is subtracted once. Overwrites all fields, so that messages can be reused.
void to_disparity_image(const cv::Mat1w& disparity, const StereoGeometry& geometry,
                        const Parameters& parameters, const std_msgs::Header& header,
                        stereo_msgs::DisparityImage& message);

/// Returns the disparities in px, in the memory of the message, as stereo_image_proc reads them: in
/// the byte order of this machine. Refuses a message whose fields do not describe its data.
Result<cv::Mat1f> to_disparities(const stereo_msgs::DisparityImage& message);

/// Fills `message` with the fields x, y, z and, depending on the layout, rgb or intensity.
/// Overwrites all fields, so that messages can be reused.
void to_point_cloud2(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
                     const CloudLayout& layout, const std_msgs::Header& header,
                     sensor_msgs::PointCloud2& message);
/// The same for disparities in px of which those below `min_disparity` are invalid.
void to_point_cloud2(const cv::Mat1f& disparity, float min_disparity, const Reprojection& r,
                     const cv::Mat& color, const CloudLayout& layout,
                     const std_msgs::Header& header, sensor_msgs::PointCloud2& message);

}  // namespace fpga_stereo
