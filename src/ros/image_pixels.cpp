#include "ros/image_pixels.hpp"

#include <cv_bridge/cv_bridge.h>
#include <fmt/format.h>
#include <sensor_msgs/image_encodings.h>

#include <boost/endian/conversion.hpp>
#include <vector>

#include "core/printable.hpp"

namespace fpga_stereo {
namespace {

namespace enc = sensor_msgs::image_encodings;

constexpr std::size_t kMaxEncodingBytes = 32;  // the longest name of sensor_msgs has 13
constexpr int kMaxChannels = 4;
const cv::Size kMaxImage(65535, 65535);

/// What an encoding says about a pixel.
struct PixelFormat {
  int type = 0;  // of OpenCV
  PixelLayout layout;
};

Result<PixelFormat> format_of(const sensor_msgs::Image& image, const std::string& name) {
  const Error unknown = image_error(
      image, name,
      "the encoding is unknown; allowed are mono8, mono16, bgr8, rgb8, bgra8, rgba8, bayer_*8 and "
      "the others of sensor_msgs/image_encodings.h");
  if (image.encoding.size() > kMaxEncodingBytes) return unknown;
  try {
    const int channels = enc::numChannels(image.encoding);
    if (channels < 1 || channels > kMaxChannels) {
      return image_error(image, name, fmt::format("allowed are 1 to {} channels", kMaxChannels));
    }
    const auto channel_bytes = static_cast<std::uint64_t>(enc::bitDepth(image.encoding)) / 8;
    return PixelFormat{cv_bridge::getCvType(image.encoding),
                       {channel_bytes * static_cast<std::uint64_t>(channels), channel_bytes}};
  } catch (const std::runtime_error&) {  // also the base of cv_bridge's exceptions
    return unknown;
  }
}

/// Returns a copy with the bytes of each channel in reverse order.
cv::Mat swap_bytes(const cv::Mat& pixels) {
  const int channel_bytes = static_cast<int>(pixels.elemSize1());
  const int pixel_bytes = static_cast<int>(pixels.elemSize());
  cv::Mat swapped(pixels.size(), pixels.type());
  const cv::Mat from(pixels.size(), CV_8UC(pixel_bytes), pixels.data, pixels.step);
  cv::Mat to(pixels.size(), CV_8UC(pixel_bytes), swapped.data, swapped.step);
  std::vector<int> pairs;
  for (int byte = 0; byte < pixel_bytes; ++byte) {
    const int in_channel = byte % channel_bytes;
    pairs.insert(pairs.end(), {byte, byte - in_channel + channel_bytes - 1 - in_channel});
  }
  cv::mixChannels(&from, 1, &to, 1, pairs.data(), pairs.size() / 2);
  return swapped;
}

}  // namespace

Error image_error(const sensor_msgs::Image& image, const std::string& name,
                  const std::string& why) {
  return {ErrorKind::kInvalid,
          fmt::format("{} image with encoding \"{}\", {}x{}, step {}, {} bytes: {}", name,
                      printable(image.encoding), image.width, image.height, image.step,
                      image.data.size(), why)};
}

Status check_layout(const sensor_msgs::Image& image, const PixelLayout& layout, cv::Size max_size,
                    const std::string& name) {
  const auto refuse = [&](const std::string& why) { return image_error(image, name, why); };
  if (image.width == 0 || image.height == 0) return refuse("it has no pixels");
  if (image.width > static_cast<std::uint32_t>(max_size.width) ||
      image.height > static_cast<std::uint32_t>(max_size.height)) {
    return refuse(fmt::format("allowed are up to {}x{}", max_size.width, max_size.height));
  }
  const std::uint64_t row = image.width * layout.pixel_bytes;
  if (image.step < row || image.step % layout.channel_bytes != 0) {
    return refuse(layout.channel_bytes == 1
                      ? fmt::format("the step must be {} or more", row)
                      : fmt::format("the step must be a multiple of {} from {} on",
                                    layout.channel_bytes, row));
  }
  const std::uint64_t size = std::uint64_t{image.step} * image.height;
  if (image.data.size() != size) return refuse(fmt::format("the data must have {} bytes", size));
  return {};
}

Result<cv::Mat> pixels_of(const sensor_msgs::Image& image, const std::string& name) {
  const Result<PixelFormat> format = format_of(image, name);
  if (!format) return format.error();
  if (Status layout = check_layout(image, format->layout, kMaxImage, name); !layout) {
    return layout.error();
  }
  // OpenCV has no constant images; nobody writes into this one.
  const cv::Mat pixels(static_cast<int>(image.height), static_cast<int>(image.width), format->type,
                       const_cast<std::uint8_t*>(image.data.data()), image.step);
  constexpr bool kIsBigEndian = boost::endian::order::native == boost::endian::order::big;
  const bool is_native =
      format->layout.channel_bytes == 1 || (image.is_bigendian != 0) == kIsBigEndian;
  return is_native ? pixels : swap_bytes(pixels);
}

}  // namespace fpga_stereo
