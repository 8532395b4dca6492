// From a calibrated camera pair to the rectification meshes that pipeline and board take.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "fpga_stereo/core/mesh.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// One camera, with the meaning of the fields of sensor_msgs/CameraInfo.
struct CameraCalibration {
  int width = 0, height = 0;     // px, at full resolution, as calibrated
  std::string distortion_model;  // plumb_bob or rational_polynomial
  std::vector<double> D;         // k1 k2 t1 t2 k3 [k4 k5 k6]; empty or all zero: none
  std::array<double, 9> K{};     // row-major
  std::array<double, 9> R{};
  std::array<double, 12> P{};
  int binning_x = 0, binning_y = 0;  // 0 means 1
  cv::Rect roi;                      // full-resolution px; all 0 means everything

  /// Size of the images that this camera delivers: region of interest over binning.
  cv::Size image_size() const;

  bool operator==(const CameraCalibration& other) const;
};

/// What turns disparities into metres, after binning and region of interest.
struct StereoGeometry {
  cv::Size image_size;
  double fx = 0, fy = 0;        // px, of the rectified pair
  double cx = 0, cx_right = 0;  // px
  double cy = 0;                // px
  double baseline = 0;          // m, > 0
};

/// Rectified pixel -> raw pixel, exact. Not finite where there is no such point.
using ExactMap = std::function<cv::Point2d(double x, double y)>;

/// Difference between a mesh and the exact map, Euclidean, px, over the rectified pixels whose
/// source lies in the raw image; the rounding to 1/32 px included.
struct MeshDeviation {
  double max = 0;
  double rms = 0;
  cv::Point max_at;  // rectified pixel with the maximum
};

/// What the circular line buffer of the board must hold for a mesh. One raw pixel enters and one
/// rectified pixel leaves per clock, both in raster order.
struct LineBufferNeed {
  int rows_above = 0;           // B_u: rows of the raw image above the output row that are read
  int rows_below = 0;           // B_l: rows below it
  std::int64_t read_start = 0;  // T_s: raw pixels written before the first pixel can be read
  int rows = 0;                 // rows that the buffer must have
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
  CameraRectification right;  // shifted by min_disparity: what the search starts from
  Mesh right_unshifted;       // the right image as others expect it
};

/// The exact map of a camera model (R. Hartley, A. Zisserman, "Multiple View Geometry"; distortion
/// as in OpenCV's calib3d): inverse of P R, distort, project with K. Binning and region of interest
/// move and scale K and P as image_geometry::PinholeCameraModel does.
/// `shift_x` moves the rectified image to the right by so many px.
ExactMap exact_map(const CameraCalibration& camera, double shift_x = 0);

/// The exact map of a homography (the paper's Eq. 1-2) from rectified to raw pixels, row-major.
ExactMap exact_map(const std::array<double, 9>& homography, double shift_x = 0);

/// Mesh of a map. Refuses a map that the mesh cannot follow (more than 1 px off).
Result<CameraRectification> make_rectification(const ExactMap& map, cv::Size rectified,
                                               cv::Size raw, const std::string& camera);

/// Difference of `mesh` from `map` for raw images of size `raw`.
MeshDeviation mesh_deviation(const Mesh& mesh, const ExactMap& map, cv::Size raw);

/// Rows and start that `mesh` needs of a line buffer for raw images of size `raw`.
LineBufferNeed line_buffer_need(const Mesh& mesh, cv::Size raw);

/// Refuses a mesh that needs more rows than a buffer of `rows` rows has.
Status check_line_buffer(const LineBufferNeed& need, int rows, const std::string& camera);

/// Refuses a calibration that no rectification can be made from, by camera and field.
Status validate(const CameraCalibration& camera, const std::string& name);

/// Everything for a pair of camera models. Refuses what validate() refuses and pairs whose sizes,
/// focal lengths or cy differ or whose baseline is not positive.
Result<StereoRectification> make_stereo_rectification(const CameraCalibration& left,
                                                      const CameraCalibration& right,
                                                      int min_disparity);

/// The same for a pair that is rectified already: meshes that move nothing.
/// `geometry` gives the size; the rest of it is passed on.
StereoRectification identity_rectification(const StereoGeometry& geometry, int min_disparity);

}  // namespace fpga_stereo
