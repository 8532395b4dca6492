// Images, disparities and calibrations in files. Every function throws std::runtime_error that
// names the file and what is wrong with it.
#pragma once

#include <sensor_msgs/CameraInfo.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

/// 8UC1 or 8UC3 (bgr), as the file has it; deeper pixels are reduced to 8 bits.
cv::Mat read_image(const std::string& path);
/// The same as grey, as a node sees it that gets the image as a message.
cv::Mat1b read_grey(const std::string& path);
/// The first channel of ground truth and masks.
cv::Mat1b read_first_channel(const std::string& path);

/// Any image in the format that the extension says.
void write_image(const std::string& path, const cv::Mat& image);
/// Throws UsageError if no picture can be written to a file of that extension. `option` is named.
void require_picture_extension(const std::string& option, const std::string& path);
/// Creates a folder and those above it.
void create_folder(const std::string& path);

/// Throws UsageError unless `path` ends on .png or .pfm, the formats that lose nothing.
void require_disparity_extension(const std::string& path);
/// .png: the 16 bits of each pixel as they are. .pfm: px, `min_disparity` added, none is infinite.
void write_disparity(const std::string& path, const cv::Mat1w& disparity, int min_disparity);

/// camera_info from YAML as camera_calibration writes it.
sensor_msgs::CameraInfo read_camera_info(const std::string& path);
void write_camera_info(const std::string& path, const std::string& camera,
                       const sensor_msgs::CameraInfo& info);

/// The images that `arguments` stand for, sorted by name: files, folders (every image in them) and
/// patterns with * ? []. `option` is named where there is none.
std::vector<std::string> list_images(const std::string& option,
                                     const std::vector<std::string>& arguments);

}  // namespace fpga_stereo::tools
