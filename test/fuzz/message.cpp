// libFuzzer target for the ROS messages that anybody may publish: images, disparity images and
// camera_infos. The input selects their fields from values that are likely to hurt.
#include <fuzzer/FuzzedDataProvider.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <iterator>
#include <numeric>
#include <opencv2/core/utility.hpp>
#include <string>

#include "fuzz/budget.hpp"
#include "ros/conversions.hpp"
#include "ros/image_pixels.hpp"

namespace {

using fpga_stereo::test::require;

constexpr const char* kEncodings[] = {"mono8",  "mono16", "bgr8",   "rgb8",          "bgra8",
                                      "rgba8",  "bgr16",  "rgba16", "bayer_rggb8",   "bayer_grbg16",
                                      "yuv422", "32FC1",  "64FC4",  "8UC1",          "8SC2",
                                      "8UC5",   "16SC",   "8UC-1",  "8UC4294967295", ""};
constexpr std::uint32_t kNumbers[] = {0,  1,   2,     3,     4,        7,        8,          16,
                                      33, 160, 65535, 65536, 1U << 29, 1U << 31, 4294967295U};
constexpr double kReals[] = {0, 1, -1, 0.5, 8, 300, 1e9, 1e300, -1e300, 1e-300, INFINITY, NAN};

std::uint32_t number(FuzzedDataProvider& input) {
  return input.ConsumeBool() ? input.PickValueInArray(kNumbers)
                             : input.ConsumeIntegralInRange<std::uint32_t>(0, 40);
}

sensor_msgs::Image image(FuzzedDataProvider& input) {
  sensor_msgs::Image image;
  image.encoding = input.ConsumeIntegralInRange(0, 9) == 0 ? input.ConsumeRandomLengthString(40)
                                                           : input.PickValueInArray(kEncodings);
  image.width = number(input);
  image.height = number(input);
  image.is_bigendian = input.ConsumeIntegralInRange<std::uint8_t>(0, 2);
  const std::uint32_t rest = number(input);
  image.step = input.ConsumeBool()
                   ? rest
                   : image.width * input.PickValueInArray({1U, 2U, 3U, 4U, 8U, 32U}) + rest % 5;
  // The right size in 32 bits, in many cases.
  std::uint32_t size = image.step * image.height;
  if (input.ConsumeIntegralInRange(0, 3) == 0) size += number(input) - 1;
  image.data.resize(std::min<std::uint32_t>(size, 20000));
  const std::string pixels = input.ConsumeRandomLengthString(64);
  std::copy_n(pixels.begin(), std::min(pixels.size(), image.data.size()), image.data.begin());
  return image;
}

/// Reads all pixels, so that the sanitizer sees it.
void require_readable(const cv::Mat& pixels, const sensor_msgs::Image& message) {
  require(pixels.cols == static_cast<int>(message.width), "the pixels have the width");
  require(pixels.rows == static_cast<int>(message.height), "the pixels have the height");
  unsigned sum = 0;
  for (int y = 0; y < pixels.rows; ++y) {
    const std::uint8_t* row = pixels.ptr(y);
    sum =
        std::accumulate(row, row + static_cast<std::size_t>(pixels.cols) * pixels.elemSize(), sum);
  }
  require(sum != 1234567890, "a sum that nobody expects");
}

void take(const sensor_msgs::Image& message) {
  const auto shared = boost::make_shared<const sensor_msgs::Image>(message);
  const auto pixels = fpga_stereo::pixels_of(*shared, "left");
  const auto grey = fpga_stereo::to_grey(shared, "left");
  const auto bgr = fpga_stereo::to_bgr(shared, "left");
  if (pixels) require_readable(*pixels, *shared);
  for (const auto* decoded : {&grey, &bgr}) {
    if (!*decoded) {
      require(!decoded->error().message.empty() && decoded->error().message.size() < 600,
              "a refusal has a short reason");
      continue;
    }
    require(static_cast<bool>(pixels), "only what can be read is decoded");
    require((**decoded).depth() == CV_8U, "decoded images have 8 bits");
    require_readable(**decoded, *shared);
  }
  if (grey) require(grey->channels() == 1, "grey images have one channel");
  stereo_msgs::DisparityImage disparity;
  disparity.image = message;
  if (const auto floats = fpga_stereo::to_disparities(disparity))
    require_readable(*floats, disparity.image);
}

template <class Values>
void fill(FuzzedDataProvider& input, Values& values) {
  for (double& value : values) {
    if (input.ConsumeIntegralInRange(0, 15) == 0) value = input.PickValueInArray(kReals);
  }
}

/// A camera_info that is good but for some fields.
sensor_msgs::CameraInfo camera_info(FuzzedDataProvider& input, bool is_right) {
  sensor_msgs::CameraInfo info;
  info.width = info.height = 8;
  info.distortion_model =
      input.ConsumeIntegralInRange(0, 15) == 0 ? input.ConsumeRandomLengthString(80) : "plumb_bob";
  info.D.assign(input.ConsumeIntegralInRange(0, 15) == 0 ? number(input) % 1000 : 5, 0);
  info.K = {8, 0, 4, 0, 8, 4, 0, 0, 1};
  info.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.P = {8, 0, 4, is_right ? -0.8 : 0, 0, 8, 4, 0, 0, 0, 1, 0};
  for (std::uint32_t* field :
       {&info.width, &info.height, &info.binning_x, &info.binning_y, &info.roi.x_offset,
        &info.roi.y_offset, &info.roi.width, &info.roi.height}) {
    if (input.ConsumeIntegralInRange(0, 15) == 0) *field = number(input);
  }
  fill(input, info.D);
  fill(input, info.K);
  fill(input, info.R);
  fill(input, info.P);
  return info;
}

void take(const sensor_msgs::CameraInfo& left_info, const sensor_msgs::CameraInfo& right_info) {
  const auto left = fpga_stereo::to_calibration(left_info, "left");
  const auto right = fpga_stereo::to_calibration(right_info, "right");
  if (!left || !right) return;
  const auto back = fpga_stereo::to_calibration(fpga_stereo::to_camera_info(*left, {}), "left");
  require(static_cast<bool>(back), "a calibration has a camera_info");
  const auto rectified = fpga_stereo::make_stereo_geometry(
      fpga_stereo::rectified_calibration(*left), fpga_stereo::rectified_calibration(*right));
  if (rectified) require(rectified->baseline > 0, "the baseline is positive");
  if (left->width > 16 || left->height > 16) return;  // the rectification is not what is tested
  const auto rectification = fpga_stereo::make_stereo_rectification(*left, *right, 0);
  if (!rectification) {
    require(!rectification.error().message.empty(), "a refusal has a reason");
    return;
  }
  require(std::isfinite(rectification->geometry.fx) && rectification->geometry.baseline > 0,
          "the geometry is possible");
  require(rectification->left.mesh.size == left->image_size(),
          "the mesh has the size of the image");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool is_set_up = [] {
    cv::setNumThreads(0);
    return true;
  }();
  require(is_set_up, "OpenCV uses one thread");
  FuzzedDataProvider input(data, size);
  const fpga_stereo::test::Budget budget(size, {0.1, 1e-4, 8 << 20, 1024});
  if (input.ConsumeBool()) {
    take(image(input));
  } else {
    const auto left = camera_info(input, false);
    take(left, camera_info(input, true));
  }
  return 0;
}
