// How good disparities are without ground truth.
#pragma once

#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/convert.hpp"
#include "support/chessboard.hpp"

namespace fpga_stereo::tools {

/// Marks a pixel without a value.
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

/// Returns the right image scaled and shifted to the median and the interquartile range of the left
/// one, because the cameras of a pair expose differently.
cv::Mat1f match_brightness(const cv::Mat1b& left, const cv::Mat1b& right);

/// Predicts the left image from the right one: pixel (x, y) from (x - d, y), bilinear. Returns the
/// absolute difference in grey levels; NaN where `disparity` (px, NaN: none) gives no prediction.
cv::Mat1f prediction_error(const cv::Mat1b& left, const cv::Mat1f& right,
                           const cv::Mat1f& disparity);

/// Values of many images. NaN is left out.
class Values {
 public:
  void add(const cv::Mat1f& image);
  /// Returns the mean; NaN without values.
  double mean() const;
  /// Returns the median, the lower of two; NaN without values.
  double median() const;

 private:
  std::vector<float> values_;
};

/// What the disparities of a chessboard give.
struct BoardMeasures {
  double coverage = 0;         // pixels between the outer corners that have a disparity, percent
  double rms_distance = 0;     // of these points from their plane, in the unit of the baseline
  double median_distance = 0;  // likewise
  double corners = 0;          // corners with a disparity, percent
  double pitch = 0;            // mean distance of neighbouring corners
};

/// Measures a chessboard whose corners in the left rectified image are `corners`. The disparity of
/// a corner is the median of the 5 x 5 pixels around it. The plane is that with the least squared
/// distances. Measures that lack points are NaN.
BoardMeasures measure_board(const Corners& corners, cv::Size board, const cv::Mat1w& disparity,
                            const Reprojection& reprojection);

}  // namespace fpga_stereo::tools
