#include "ros/conversions.hpp"

#include <cv_bridge/cv_bridge.h>
#include <fmt/format.h>
#include <sensor_msgs/image_encodings.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/printable.hpp"
#include "core/stages.hpp"
#include "ros/image_pixels.hpp"

namespace fpga_stereo {
namespace {

namespace enc = sensor_msgs::image_encodings;

constexpr std::size_t kMaxExceptionBytes = 200;
constexpr std::size_t kMaxModelBytes = 64;  // of the name of a distortion model

/// Decodes with cv_bridge, and returns its exceptions as errors.
Result<cv::Mat> convert(const sensor_msgs::ImageConstPtr& image, const std::string& encoding,
                        const std::string& camera) {
  Result<cv::Mat> pixels = pixels_of(*image, camera);
  if (!pixels || image->encoding == encoding) return pixels;
  try {
    const auto decoded =
        boost::make_shared<const cv_bridge::CvImage>(image->header, image->encoding, *pixels);
    return cv_bridge::cvtColor(decoded, encoding)->image;
  } catch (const std::exception& e) {  // of OpenCV, if the size does not suit the encoding
    return image_error(*image, camera,
                       printable(e.what(), kMaxExceptionBytes) +
                           "; allowed are mono8, mono16, bgr8, rgb8, bgra8, rgba8 and bayer_*8");
  }
}

sensor_msgs::PointField field(const std::string& name, int offset) {
  sensor_msgs::PointField result;
  result.name = name;
  result.offset = static_cast<std::uint32_t>(offset);
  result.datatype = sensor_msgs::PointField::FLOAT32;
  result.count = 1;
  return result;
}

/// Returns the window of possible disparities, with the bounds of image_pipeline (disparity.cpp of
/// noetic). That computes them before it knows the size of the image; this function uses the size.
/// Only window matching has a border of half a window. With `dense`, every pixel has a disparity.
sensor_msgs::RegionOfInterest valid_window(cv::Size size, const Parameters& p) {
  sensor_msgs::RegionOfInterest window;
  if (p.dense) {
    window.width = static_cast<std::uint32_t>(size.width);
    window.height = static_cast<std::uint32_t>(size.height);
    return window;
  }
  const bool has_border = p.stereo_algorithm == StereoAlgorithm::kWindow;
  const int border = has_border ? p.correlation_window_size / 2 : 0;
  const int left = p.disparity_range + p.min_disparity + border - 1;
  const int right_margin =
      p.min_disparity >= 0 ? border + p.min_disparity : std::max(border, -p.min_disparity);
  window.x_offset = static_cast<std::uint32_t>(std::clamp(left, 0, size.width));
  window.y_offset = static_cast<std::uint32_t>(std::min(border, size.height));
  window.width = static_cast<std::uint32_t>(std::max(0, size.width - 1 - right_margin - left));
  window.height = static_cast<std::uint32_t>(std::max(0, size.height - 1 - 2 * border));
  return window;
}

/// Fills all fields but the data.
void describe_cloud(const Cloud& cloud, const CloudLayout& layout, const std_msgs::Header& header,
                    sensor_msgs::PointCloud2& message) {
  message.header = header;
  message.width = static_cast<std::uint32_t>(cloud.width);
  message.height = static_cast<std::uint32_t>(cloud.height);
  message.fields = {field("x", 0), field("y", 4), field("z", 8)};
  if (layout.color == PointColor::kRgb) {
    message.fields.push_back(field("rgb", layout.color_offset()));
  } else if (layout.color == PointColor::kMono) {
    message.fields.push_back(field("intensity", layout.color_offset()));
  }
  message.point_step = static_cast<std::uint32_t>(layout.point_step());
  message.row_step = message.point_step * message.width;
  message.is_bigendian = 0;
  message.is_dense = !layout.organized;
}

/// Fills `message` with the cloud that `make` makes, in the memory of the message.
template <class Make>
void fill_cloud(const CloudLayout& layout, const std_msgs::Header& header,
                sensor_msgs::PointCloud2& message, const Make& make) {
  Cloud cloud;
  cloud.data.swap(message.data);
  make(cloud);
  message.data.swap(cloud.data);
  describe_cloud(cloud, layout, header, message);
}

}  // namespace

Result<CameraCalibration> to_calibration(const sensor_msgs::CameraInfo& info,
                                         const std::string& name) {
  const auto refuse = [&](const std::string& problem) {
    return Error{ErrorKind::kCalibration, fmt::format("{} camera_info {}", name, problem)};
  };
  CameraCalibration c;
  const std::tuple<const char*, std::uint32_t, int*> sizes[] = {
      {"width", info.width, &c.width},
      {"height", info.height, &c.height},
      {"binning_x", info.binning_x, &c.binning_x},
      {"binning_y", info.binning_y, &c.binning_y},
      {"roi.x_offset", info.roi.x_offset, &c.roi.x},
      {"roi.y_offset", info.roi.y_offset, &c.roi.y},
      {"roi.width", info.roi.width, &c.roi.width},
      {"roi.height", info.roi.height, &c.roi.height}};
  for (const auto& [field, value, target] : sizes) {
    if (value > std::uint32_t{kMaxCalibratedSide}) {
      return refuse(fmt::format("{} = {}: allowed are 0 to {}", field, value, kMaxCalibratedSide));
    }
    *target = static_cast<int>(value);
  }
  if (info.D.size() > kMaxDistortionCoefficients) {
    return refuse(fmt::format("D has {} values: allowed are up to {}", info.D.size(),
                              kMaxDistortionCoefficients));
  }
  if (info.distortion_model.size() > kMaxModelBytes) {
    return refuse(
        fmt::format("distortion_model = \"{}\": allowed are plumb_bob and "
                    "rational_polynomial",
                    printable(info.distortion_model)));
  }
  c.distortion_model = info.distortion_model;
  c.D = info.D;
  std::copy(info.K.begin(), info.K.end(), c.K.begin());
  std::copy(info.R.begin(), info.R.end(), c.R.begin());
  std::copy(info.P.begin(), info.P.end(), c.P.begin());
  return c;
}

sensor_msgs::CameraInfo to_camera_info(const CameraCalibration& calibration,
                                       const std_msgs::Header& header) {
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(calibration.width);
  info.height = static_cast<std::uint32_t>(calibration.height);
  info.distortion_model = calibration.distortion_model;
  info.D = calibration.D;
  std::copy(calibration.K.begin(), calibration.K.end(), info.K.begin());
  std::copy(calibration.R.begin(), calibration.R.end(), info.R.begin());
  std::copy(calibration.P.begin(), calibration.P.end(), info.P.begin());
  info.binning_x = static_cast<std::uint32_t>(calibration.binning_x);
  info.binning_y = static_cast<std::uint32_t>(calibration.binning_y);
  info.roi.x_offset = static_cast<std::uint32_t>(calibration.roi.x);
  info.roi.y_offset = static_cast<std::uint32_t>(calibration.roi.y);
  info.roi.width = static_cast<std::uint32_t>(calibration.roi.width);
  info.roi.height = static_cast<std::uint32_t>(calibration.roi.height);
  return info;
}

std_msgs::Header to_header(std::int64_t stamp_ns, const std::string& frame_id) {
  std_msgs::Header header;
  header.stamp.fromNSec(static_cast<std::uint64_t>(stamp_ns));
  header.frame_id = frame_id;
  return header;
}

bool is_grey(const sensor_msgs::Image& image) { return enc::isMono(image.encoding); }

Result<cv::Mat> to_grey(const sensor_msgs::ImageConstPtr& image, const std::string& camera) {
  return convert(image, enc::MONO8, camera);
}

Result<cv::Mat> to_bgr(const sensor_msgs::ImageConstPtr& image, const std::string& camera) {
  return convert(image, is_grey(*image) ? enc::MONO8 : enc::BGR8, camera);
}

cv::Mat image_in(sensor_msgs::Image& message, const std_msgs::Header& header, cv::Size size,
                 int type) {
  message.header = header;
  message.encoding = type == CV_8UC1    ? enc::MONO8
                     : type == CV_8UC3  ? enc::BGR8
                     : type == CV_16UC1 ? enc::TYPE_16UC1
                                        : enc::TYPE_32FC1;
  message.width = static_cast<std::uint32_t>(size.width);
  message.height = static_cast<std::uint32_t>(size.height);
  message.is_bigendian = 0;
  message.step = message.width * static_cast<std::uint32_t>(CV_ELEM_SIZE(type));
  message.data.resize(static_cast<std::size_t>(message.step) * message.height);
  return cv::Mat(size, type, message.data.data(), message.step);
}

sensor_msgs::ImagePtr to_image(const cv::Mat& image, const std_msgs::Header& header) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  image.copyTo(image_in(*message, header, image.size(), image.type()));
  return message;
}

void to_disparity_image(const cv::Mat1w& disparity, const StereoGeometry& geometry,
                        const Parameters& parameters, const std_msgs::Header& header,
                        stereo_msgs::DisparityImage& message) {
  const Reprojection r = make_reprojection(geometry, parameters.min_disparity);
  message.header = header;
  message.f = static_cast<float>(geometry.fx);
  message.T = static_cast<float>(geometry.baseline);
  message.min_disparity = static_cast<float>(r.offset);
  message.max_disparity = static_cast<float>(r.offset + parameters.disparity_range - 1);
  message.delta_d = parameters.subpixel ? 1.0F / kDisparityScale : 1.0F;
  message.valid_window = valid_window(disparity.size(), parameters);

  cv::Mat1f values = image_in(message.image, header, disparity.size(), CV_32FC1);
  to_float(disparity, r.offset, message.min_disparity - 1.0F, values);
}

Result<cv::Mat1f> to_disparities(const stereo_msgs::DisparityImage& message) {
  const sensor_msgs::Image& image = message.image;
  const std::string name = "disparity";
  if (image.encoding != enc::TYPE_32FC1) {
    return image_error(image, name, "allowed is the encoding 32FC1");
  }
  if (Status layout =
          check_layout(image, {sizeof(float), sizeof(float)}, {kMaxWidth, kMaxHeight}, name);
      !layout) {
    return layout.error();
  }
  if (std::isnan(message.min_disparity)) {
    return image_error(image, name, "min_disparity is not a number");
  }
  // OpenCV has no constant images; nobody writes into this one.
  auto* const pixels = reinterpret_cast<float*>(const_cast<std::uint8_t*>(image.data.data()));
  return cv::Mat1f(static_cast<int>(image.height), static_cast<int>(image.width), pixels,
                   image.step);
}

void to_point_cloud2(const cv::Mat1w& disparity, const Reprojection& r, const cv::Mat& color,
                     const CloudLayout& layout, const std_msgs::Header& header,
                     sensor_msgs::PointCloud2& message) {
  fill_cloud(layout, header, message,
             [&](Cloud& cloud) { to_cloud(disparity, r, color, layout, cloud); });
}

void to_point_cloud2(const cv::Mat1f& disparity, float min_disparity, const Reprojection& r,
                     const cv::Mat& color, const CloudLayout& layout,
                     const std_msgs::Header& header, sensor_msgs::PointCloud2& message) {
  fill_cloud(layout, header, message,
             [&](Cloud& cloud) { to_cloud(disparity, min_disparity, r, color, layout, cloud); });
}

}  // namespace fpga_stereo
