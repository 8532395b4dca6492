// Reads the pixels of image messages, whose fields anybody may have filled.
#pragma once

#include <sensor_msgs/Image.h>

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Bytes of a pixel, and of one of its channels.
struct PixelLayout {
  std::uint64_t pixel_bytes = 0;
  std::uint64_t channel_bytes = 0;
};

/// Refuses a message without pixels, larger than `max_size`, or whose step or data do not fit its
/// size. Computes in 64 bits: in 32 bits, height * step can be a small number. `name` names the
/// image in the error.
Status check_layout(const sensor_msgs::Image& image, const PixelLayout& layout, cv::Size max_size,
                    const std::string& name);

/// Returns the pixels as they are encoded, in the memory of the message; a copy if its byte order
/// is not that of this machine. Refuses encodings that sensor_msgs does not know, and what
/// check_layout() refuses; allows sides of up to 65535 px.
Result<cv::Mat> pixels_of(const sensor_msgs::Image& image, const std::string& name);

/// Returns an error that describes the message: its encoding, size, step and number of bytes.
Error image_error(const sensor_msgs::Image& image, const std::string& name, const std::string& why);

}  // namespace fpga_stereo
