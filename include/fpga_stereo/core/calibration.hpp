// Computes the rectification meshes of pipeline and board from the calibration of a camera pair.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/core/mesh.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

constexpr int kMaxCalibratedSide = 65535;               // px, of the image that was calibrated
constexpr std::size_t kMaxDistortionCoefficients = 14;  // of OpenCV's largest distortion model

/// The calibration of one camera. Fields mean the same as in sensor_msgs/CameraInfo.
struct CameraCalibration {
  int width = 0, height = 0;     // px, full resolution, as calibrated
  std::string distortion_model;  // plumb_bob or rational_polynomial
  std::vector<double> D;         // k1 k2 t1 t2 k3 [k4 k5 k6]; no distortion if empty or all zero
  std::array<double, 9> K{};     // row-major
  std::array<double, 9> R{};
  std::array<double, 12> P{};
  int binning_x = 0, binning_y = 0;  // 0 means 1
  cv::Rect roi;                      // full-resolution px; all 0 means the whole image

  /// Returns the size of the delivered images: that of the region of interest divided by binning.
  cv::Size image_size() const;

  bool operator==(const CameraCalibration& other) const;
};

/// Both cameras of a pair.
struct StereoCalibration {
  CameraCalibration left, right;

  bool operator==(const StereoCalibration& other) const {
    return left == other.left && right == other.right;
  }
  bool operator!=(const StereoCalibration& other) const { return !(*this == other); }
};

/// The numbers that convert disparities to metres, after region of interest and binning.
struct StereoGeometry {
  cv::Size image_size;
  double fx = 0, fy = 0;        // px, of both rectified images
  double cx = 0, cx_right = 0;  // px
  double cy = 0;                // px
  double baseline = 0;          // m, > 0
};

/// Maps a rectified pixel to its source in the raw image, exactly. Not finite if there is no
/// source.
using ExactMap = std::function<cv::Point2d(double x, double y)>;

/// Euclidean distance between the sources by a mesh and by the exact map, in px, over the rectified
/// pixels whose source lies in the raw image. Includes the rounding to 1/32 px.
struct MeshDeviation {
  double max = 0;
  double rms = 0;
  cv::Point max_at;         // rectified pixel with the maximum
  std::int64_t pixels = 0;  // that the numbers are about
};

/// What a mesh needs of the board's line buffer, which is circular: one raw pixel enters and one
/// rectified pixel leaves per clock, both in raster order.
struct LineBufferNeed {
  int rows_above = 0;           // B_u: how far above the output row raw rows are read
  int rows_below = 0;           // B_l: how far below
  std::int64_t read_start = 0;  // T_s: raw pixels written before the first one may be read
  int rows = 0;                 // rows the buffer must have
};

struct CameraRectification {
  Mesh mesh;
  MeshDeviation deviation;
  LineBufferNeed line_buffer;
};

struct StereoRectification {
  StereoGeometry geometry;
  int min_disparity = 0;
  CameraRectification left;
  CameraRectification right;  // shifted by min_disparity, where the search starts
  Mesh right_unshifted;       // for the right image as published
};

/// Returns the exact map of a camera model (R. Hartley, A. Zisserman, "Multiple View Geometry";
/// distortion as in OpenCV's calib3d): inverse of P R, distortion, projection with K. Region of
/// interest and binning change K and P as in image_geometry::PinholeCameraModel.
/// `shift_x` moves the rectified image to the right, in px.
ExactMap exact_map(const CameraCalibration& camera, double shift_x = 0);

/// Returns the map of a homography (the paper's Eq. 1-2) from rectified to raw pixels, row-major.
ExactMap exact_map(const std::array<double, 9>& homography, double shift_x = 0);

/// Computes the mesh of a map for images of these sizes. Refuses a map that the mesh misses by more
/// than 1 px. `camera` names the camera in errors.
Result<CameraRectification> make_rectification(const ExactMap& map, cv::Size rectified,
                                               cv::Size raw, const std::string& camera);

/// Measures how far `mesh` deviates from `map` for raw images of size `raw`.
MeshDeviation mesh_deviation(const Mesh& mesh, const ExactMap& map, cv::Size raw);

/// Computes what `mesh` needs of a line buffer for raw images of size `raw`.
LineBufferNeed line_buffer_need(const Mesh& mesh, cv::Size raw);

/// Refuses a mesh that needs more than `rows` rows of a line buffer.
Status check_line_buffer(const LineBufferNeed& need, int rows, const std::string& camera);

/// Refuses a calibration that cannot be used. The error names the camera and the field.
Status validate(const CameraCalibration& camera, const std::string& name);

/// Returns the calibration of the camera's rectified image, which P alone describes: K is that of
/// P, R is the identity and D is empty. Keeps a K or P that validate() refuses.
CameraCalibration rectified_calibration(const CameraCalibration& camera);

/// Returns the geometry of a camera pair. Refuses calibrations that validate() refuses, and pairs
/// whose sizes, focal lengths or cy differ or whose baseline is not positive.
Result<StereoGeometry> make_stereo_geometry(const CameraCalibration& left,
                                            const CameraCalibration& right);

/// Computes the rectification of a camera pair. Refuses what make_stereo_geometry() and
/// make_rectification() refuse, and a camera of which less than 1 % of the rectified image lies in
/// the raw image.
Result<StereoRectification> make_stereo_rectification(const CameraCalibration& left,
                                                      const CameraCalibration& right,
                                                      int min_disparity);

/// Returns the rectification of a pair that is already rectified: meshes that move nothing but the
/// right image, by min_disparity. `geometry` is copied; its image size is that of the meshes.
StereoRectification identity_rectification(const StereoGeometry& geometry, int min_disparity);

}  // namespace fpga_stereo
