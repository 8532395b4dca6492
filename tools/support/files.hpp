// Reads and writes images and disparities. Every function throws std::runtime_error with the name
// of the file and what is wrong with it.
#pragma once

#include <fstream>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fpga_stereo::tools {

/// Returns the image as 8UC1 or 8UC3 (bgr), whichever the file holds; deeper pixels are reduced to
/// 8 bits.
cv::Mat read_image(const std::string& path);
/// Returns the image in grey, converted as a node converts a colour image message.
cv::Mat1b read_grey(const std::string& path);
/// Returns the first channel, which holds the values of ground truth and masks.
cv::Mat1b read_first_channel(const std::string& path);

/// Writes an image in the format of the extension.
void write_image(const std::string& path, const cv::Mat& image);
/// Throws UsageError, which names `option`, if no image can be written with this extension.
void require_picture_extension(const std::string& option, const std::string& path);
/// Opens a new text file for writing.
std::ofstream create_file(const std::string& path);
/// Closes it; throws unless everything has been written.
void close_file(std::ofstream& file, const std::string& path);
/// Creates a folder and its parents.
void create_folder(const std::string& path);

/// Throws UsageError unless `path` ends in .png or .pfm, the lossless formats for disparities.
void require_disparity_extension(const std::string& path);
/// Writes a disparity image. .png: the 16-bit values unchanged. .pfm: float, px, with
/// `min_disparity` added; invalid pixels are infinite.
void write_disparity(const std::string& path, const cv::Mat1w& disparity, int min_disparity);

/// Returns the image files that `arguments` stand for, sorted by name: files, folders (all images
/// in them) and patterns with * ? []. Throws an error that names `option` if an argument matches no
/// image.
std::vector<std::string> list_images(const std::string& option,
                                     const std::vector<std::string>& arguments);

}  // namespace fpga_stereo::tools
