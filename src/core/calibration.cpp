#include "fpga_stereo/core/calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <tuple>
#include <utility>

#include "core/printable.hpp"
#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

constexpr double kMaxRotationError = 1e-2;  // |R R^T - I|
constexpr double kMaxDifference = 1e-3;     // px between f or cy of a pair: rounding in files

/// The matrices of the delivered image, after region of interest and binning.
struct ImageCamera {
  cv::Matx33d K, R, P;
  double minus_fx_times_baseline = 0;  // px m, P[3]
};

ImageCamera image_camera(const CameraCalibration& camera) {
  ImageCamera image{cv::Matx33d(camera.K.data()), cv::Matx33d(camera.R.data()),
                    cv::Matx34d(camera.P.data()).get_minor<3, 3>(0, 0), camera.P[3]};
  const double scale_x = 1.0 / std::max(1, camera.binning_x);
  const double scale_y = 1.0 / std::max(1, camera.binning_y);
  for (cv::Matx33d* matrix : {&image.K, &image.P}) {
    (*matrix)(0, 2) -= camera.roi.x;
    (*matrix)(1, 2) -= camera.roi.y;
    for (int column = 0; column < 3; ++column) {
      (*matrix)(0, column) *= scale_x;
      (*matrix)(1, column) *= scale_y;
    }
  }
  image.minus_fx_times_baseline *= scale_x;
  return image;
}

template <class Container>
bool is_finite(const Container& values) {
  for (const double value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

// Ubuntu 20.04's fmt 6.1 has no format_string.
template <class... Arguments>
Error error(ErrorKind kind, const char* text, const Arguments&... arguments) {
  return {kind, fmt::vformat(text, fmt::format_args(fmt::make_format_args(arguments...)))};
}

std::string to_text(cv::Size size) { return fmt::format("{}x{}", size.width, size.height); }

bool is_zero(const std::vector<double>& values) {
  for (const double value : values) {
    if (value != 0) return false;
  }
  return true;
}

Status validate_distortion(const CameraCalibration& camera, const std::string& name) {
  if (is_zero(camera.D)) return {};
  const std::string& model = camera.distortion_model;
  const std::size_t expected = model == "plumb_bob" ? 5 : model == "rational_polynomial" ? 8 : 0;
  if (expected == 0) {
    return error(
        ErrorKind::kCalibration,
        "{} camera_info distortion_model = \"{}\": allowed plumb_bob or rational_polynomial", name,
        printable(model));
  }
  if (camera.D.size() != expected) {
    return error(ErrorKind::kCalibration, "{} camera_info D has {} values: {} needs {}", name,
                 camera.D.size(), model, expected);
  }
  return {};
}

Status validate_size(const CameraCalibration& camera, const std::string& name) {
  if (camera.width <= 0 || camera.height <= 0) {
    return error(ErrorKind::kCalibration,
                 "{} camera_info width x height = {}x{}: allowed 1x1 or more", name, camera.width,
                 camera.height);
  }
  const cv::Rect& roi = camera.roi;
  const bool inside = roi.x >= 0 && roi.y >= 0 && roi.width > 0 && roi.height > 0 &&
                      roi.width <= camera.width && roi.x <= camera.width - roi.width &&
                      roi.height <= camera.height && roi.y <= camera.height - roi.height;
  if (roi != cv::Rect() && !inside) {
    return error(
        ErrorKind::kCalibration,
        "{} camera_info roi {}+{}+{} does not lie within the image of {}: allowed are parts "
        "of the image, or all 0 for the whole image",
        name, to_text(roi.size()), roi.x, roi.y, to_text({camera.width, camera.height}));
  }
  if (camera.binning_x < 0 || camera.binning_y < 0 || camera.image_size().empty()) {
    return error(ErrorKind::kCalibration,
                 "{} camera_info binning {}x{} leaves no pixels: allowed 0x0 to {}", name,
                 camera.binning_x, camera.binning_y,
                 to_text(roi.empty() ? cv::Size(camera.width, camera.height) : roi.size()));
  }
  const cv::Size size = camera.image_size();
  if (size.width > kMaxWidth || size.height > kMaxHeight) {
    return error(ErrorKind::kImageSize, "{} camera_info describes images of {}: allowed up to {}",
                 name, to_text(size), to_text({kMaxWidth, kMaxHeight}));
  }
  return {};
}

/// Refuses a rectification that leaves the image black: the calibration is damaged.
Status check_coverage(const MeshDeviation& mesh, cv::Size size, const std::string& name) {
  constexpr std::int64_t kMinPercent = 1;
  const std::int64_t all = std::int64_t{size.width} * size.height;
  if (mesh.pixels * 100 >= all * kMinPercent) return {};
  return error(ErrorKind::kCalibration,
               "{} camera: {} of {} rectified pixels lie in the raw image: allowed is {} % or more",
               name, mesh.pixels, all, kMinPercent);
}

}  // namespace

cv::Size CameraCalibration::image_size() const {
  const cv::Size full = roi.empty() ? cv::Size(width, height) : roi.size();
  return {full.width / std::max(1, binning_x), full.height / std::max(1, binning_y)};
}

bool CameraCalibration::operator==(const CameraCalibration& o) const {
  return std::tie(width, height, distortion_model, D, K, R, P, binning_x, binning_y, roi) ==
         std::tie(o.width, o.height, o.distortion_model, o.D, o.K, o.R, o.P, o.binning_x,
                  o.binning_y, o.roi);
}

ExactMap exact_map(const CameraCalibration& camera, double shift_x) {
  const ImageCamera image = image_camera(camera);
  const cv::Matx33d to_ray = (image.P * image.R).inv();
  std::array<double, 8> k{};
  if (!is_zero(camera.D)) std::copy(camera.D.begin(), camera.D.end(), k.begin());

  return [=](double column, double row) -> cv::Point2d {
    const cv::Vec3d ray = to_ray * cv::Vec3d(column - shift_x, row, 1);
    if (!(ray[2] > 0)) return {std::nan(""), std::nan("")};  // the ray points behind the camera
    const double x = ray[0] / ray[2];
    const double y = ray[1] / ray[2];
    const double r2 = x * x + y * y;
    const double radial =
        (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
    const cv::Vec3d distorted(x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x),
                              y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y, 1);
    const cv::Vec3d pixel = image.K * distorted;
    return {pixel[0], pixel[1]};
  };
}

ExactMap exact_map(const std::array<double, 9>& homography, double shift_x) {
  const cv::Matx33d matrix(homography.data());
  return [=](double column, double row) -> cv::Point2d {
    const cv::Vec3d pixel = matrix * cv::Vec3d(column - shift_x, row, 1);
    return {pixel[0] / pixel[2], pixel[1] / pixel[2]};
  };
}

Status validate(const CameraCalibration& camera, const std::string& name) {
  if (camera.K[0] == 0) {
    return error(ErrorKind::kUncalibrated,
                 "{} camera is uncalibrated: camera_info K[0] = 0; calibrate it first, for example "
                 "with camera_calibration",
                 name);
  }
  if (Status status = validate_size(camera, name); !status) return status;
  const std::pair<const char*, bool> fields[] = {{"K", is_finite(camera.K)},
                                                 {"D", is_finite(camera.D)},
                                                 {"R", is_finite(camera.R)},
                                                 {"P", is_finite(camera.P)}};
  for (const auto& [field, finite] : fields) {
    if (!finite) {
      return error(ErrorKind::kCalibration, "{} camera_info {} has a value that is not finite",
                   name, field);
    }
  }
  for (const int i : {0, 4}) {
    if (camera.K[i] <= 0) {
      return error(ErrorKind::kCalibration,
                   "{} camera_info K[{}] = {:.10g}: the focal length must be positive", name, i,
                   camera.K[i]);
    }
  }
  for (const int i : {0, 5}) {
    if (camera.P[i] <= 0) {
      return error(ErrorKind::kCalibration,
                   "{} camera_info P[{}] = {:.10g}: the focal length must be positive; a stereo "
                   "calibration sets it",
                   name, i, camera.P[i]);
    }
  }
  const cv::Matx33d R(camera.R.data());
  const double off = cv::norm(R * R.t() - cv::Matx33d::eye());
  if (off > kMaxRotationError || cv::determinant(R) < 0) {
    return error(ErrorKind::kCalibration,
                 "{} camera_info R is not a rotation: |R R^T - I| = {:.10g}, determinant {:.10g}; "
                 "allowed are up to {} and a determinant of 1. Without rectification R is the "
                 "identity",
                 name, off, cv::determinant(R), kMaxRotationError);
  }
  if (camera.P[10] != 1 || camera.P[8] != 0 || camera.P[9] != 0) {
    return error(ErrorKind::kCalibration,
                 "{} camera_info P has the third row {:.10g} {:.10g} {:.10g}: allowed 0 0 1", name,
                 camera.P[8], camera.P[9], camera.P[10]);
  }
  return validate_distortion(camera, name);
}

CameraCalibration rectified_calibration(const CameraCalibration& camera) {
  CameraCalibration rectified = camera;
  rectified.D.clear();
  rectified.R = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const auto& P = camera.P;
  if (camera.K[0] != 0 && P[0] > 0 && P[5] > 0) {
    rectified.K = {P[0], P[1], P[2], P[4], P[5], P[6], P[8], P[9], P[10]};
  }
  return rectified;
}

Result<StereoGeometry> make_stereo_geometry(const CameraCalibration& left,
                                            const CameraCalibration& right) {
  if (Status status = validate(left, "left"); !status) return status.error();
  if (Status status = validate(right, "right"); !status) return status.error();

  StereoGeometry geometry;
  geometry.image_size = left.image_size();
  if (left.image_size() != right.image_size()) {
    return error(ErrorKind::kCalibration,
                 "left and right camera_info describe images of {} and {}: the sizes must be equal",
                 to_text(left.image_size()), to_text(right.image_size()));
  }
  const ImageCamera left_image = image_camera(left);
  const ImageCamera right_image = image_camera(right);
  const auto check_equal = [&](const char* what, double l, double r) -> Status {
    if (std::abs(l - r) <= kMaxDifference) return {};
    return error(ErrorKind::kCalibration,
                 "{} of left and right camera_info P differ ({:.10g} and {:.10g}): they must be "
                 "equal for a rectified pair",
                 what, l, r);
  };
  if (Status s = check_equal("fx", left_image.P(0, 0), right_image.P(0, 0)); !s) return s.error();
  if (Status s = check_equal("fy", left_image.P(1, 1), right_image.P(1, 1)); !s) return s.error();
  if (Status s = check_equal("cy", left_image.P(1, 2), right_image.P(1, 2)); !s) return s.error();
  geometry.fx = right_image.P(0, 0);
  geometry.fy = left_image.P(1, 1);
  geometry.cx = left_image.P(0, 2);
  geometry.cx_right = right_image.P(0, 2);
  geometry.cy = left_image.P(1, 2);
  geometry.baseline = -right_image.minus_fx_times_baseline / geometry.fx;
  if (!(geometry.baseline > 0)) {
    return error(ErrorKind::kCalibration,
                 "right camera_info P[3] = {:.10g}: it must be minus focal length times baseline, "
                 "so negative; are left and right swapped?",
                 right.P[3]);
  }
  return geometry;
}

Result<StereoRectification> make_stereo_rectification(const CameraCalibration& left,
                                                      const CameraCalibration& right,
                                                      int min_disparity) {
  const Result<StereoGeometry> geometry = make_stereo_geometry(left, right);
  if (!geometry) return geometry.error();
  StereoRectification pair;
  pair.min_disparity = min_disparity;
  pair.geometry = *geometry;
  const cv::Size size = pair.geometry.image_size;
  auto left_rectification = make_rectification(exact_map(left), size, size, "left");
  if (!left_rectification) return left_rectification.error();
  pair.left = *left_rectification;
  if (Status s = check_coverage(pair.left.deviation, size, "left"); !s) return s.error();
  auto right_rectification =
      make_rectification(exact_map(right, min_disparity), size, size, "right");
  if (!right_rectification) return right_rectification.error();
  pair.right = *right_rectification;
  CameraRectification unshifted = pair.right;
  if (min_disparity != 0) {
    auto made = make_rectification(exact_map(right), size, size, "right");
    if (!made) return made.error();
    unshifted = std::move(*made);
  }
  if (Status s = check_coverage(unshifted.deviation, size, "right"); !s) return s.error();
  pair.right_unshifted = std::move(unshifted.mesh);
  return pair;
}

StereoRectification identity_rectification(const StereoGeometry& geometry, int min_disparity) {
  const cv::Size size = geometry.image_size;
  StereoRectification pair;
  pair.geometry = geometry;
  pair.min_disparity = min_disparity;
  pair.left.mesh = pair.right_unshifted = Mesh::shift(size, 0);
  pair.right.mesh = Mesh::shift(size, -min_disparity);
  pair.left.line_buffer = line_buffer_need(pair.left.mesh, size);
  pair.right.line_buffer = line_buffer_need(pair.right.mesh, size);
  return pair;
}

}  // namespace fpga_stereo
