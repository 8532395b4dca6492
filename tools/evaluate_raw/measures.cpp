#include "evaluate_raw/measures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace fpga_stereo::tools {
namespace {

/// Returns the lower median; NaN without values. Reorders them.
template <class T>
double lower_median(std::vector<T>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the quartiles of the grey values.
std::array<int, 3> quartiles(const cv::Mat1b& image) {
  std::vector<std::uint8_t> values(image.begin(), image.end());
  std::array<int, 3> found{};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * (i + 1) / 4);
    std::nth_element(values.begin(), at, values.end());
    found[i] = *at;
  }
  return found;
}

template <class T>
double mean_of(const std::vector<T>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Returns the point of a left pixel with disparity `d`, offset included.
cv::Vec3d point(double u, double v, double d, const Reprojection& r) {
  return {r.baseline * (u - r.cx) / d, r.baseline * r.fx / r.fy * (v - r.cy) / d,
          r.fx * r.baseline / d};
}

/// Returns the distances of the points from the plane with the least squared distances.
std::vector<double> plane_distances(const std::vector<cv::Vec3d>& points) {
  cv::Vec3d centre;
  for (const cv::Vec3d& p : points) centre += p / static_cast<double>(points.size());
  cv::Matx33d covariance = cv::Matx33d::zeros();
  for (const cv::Vec3d& p : points) covariance += (p - centre) * (p - centre).t();
  cv::Vec3d values;
  cv::Matx33d vectors;
  cv::eigen(covariance, values, vectors);  // in descending order
  const cv::Vec3d normal(vectors(2, 0), vectors(2, 1), vectors(2, 2));
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const cv::Vec3d& p : points) distances.push_back(std::abs(normal.dot(p - centre)));
  return distances;
}

/// Returns the pixels between the outer corners.
cv::Mat1b inside(const Corners& corners, cv::Size image) {
  std::vector<cv::Point2f> hull;
  cv::convexHull(corners, hull);
  const std::vector<cv::Point> polygon(hull.begin(), hull.end());
  cv::Mat1b mask(image, std::uint8_t{0});
  cv::fillConvexPoly(mask, polygon, 255);
  return mask;
}

/// Returns the median disparity of the 5 x 5 pixels around a corner; NaN if none has a disparity.
double corner_disparity(const cv::Mat1f& disparity, const cv::Point2f& corner) {
  constexpr int kRadius = 2;
  const cv::Point middle(cvRound(corner.x), cvRound(corner.y));
  const cv::Rect around(middle.x - kRadius, middle.y - kRadius, 2 * kRadius + 1, 2 * kRadius + 1);
  std::vector<float> values;
  const cv::Mat1f near = disparity(around & cv::Rect({0, 0}, disparity.size()));
  std::copy_if(near.begin(), near.end(), std::back_inserter(values),
               [](float d) { return !std::isnan(d); });
  return lower_median(values);
}

/// Returns the distances of all neighbours along rows and columns that both have a point.
std::vector<double> pitches(const std::vector<std::optional<cv::Vec3d>>& points, cv::Size board) {
  std::vector<double> found;
  const auto add = [&](int a, int b) {
    const auto &first = points[static_cast<std::size_t>(a)],
               &second = points[static_cast<std::size_t>(b)];
    if (first && second) found.push_back(cv::norm(*first - *second));
  };
  for (int y = 0; y < board.height; ++y) {
    for (int x = 0; x < board.width; ++x) {
      const int i = y * board.width + x;
      if (x + 1 < board.width) add(i, i + 1);
      if (y + 1 < board.height) add(i, i + board.width);
    }
  }
  return found;
}

}  // namespace

cv::Mat1f match_brightness(const cv::Mat1b& left, const cv::Mat1b& right) {
  const auto left_quartiles = quartiles(left), right_quartiles = quartiles(right);
  const double left_range = left_quartiles[2] - left_quartiles[0];
  const double right_range = right_quartiles[2] - right_quartiles[0];
  const double gain = right_range > 0 ? left_range / right_range : 1;
  cv::Mat1f matched;
  right.convertTo(matched, CV_32F, gain, left_quartiles[1] - gain * right_quartiles[1]);
  return matched;
}

cv::Mat1f prediction_error(const cv::Mat1b& left, const cv::Mat1f& right,
                           const cv::Mat1f& disparity) {
  cv::Mat1f error(left.size(), kNone);
  for (int y = 0; y < left.rows; ++y) {
    for (int x = 0; x < left.cols; ++x) {
      const double source = x - disparity(y, x);
      const bool inside = source >= 0 && source <= right.cols - 1;  // false for NaN
      if (!inside) continue;
      const int u = std::min(static_cast<int>(source), std::max(right.cols - 2, 0));
      const double fraction = source - u;
      const double grey =
          (1 - fraction) * right(y, u) + fraction * right(y, std::min(u + 1, right.cols - 1));
      error(y, x) = static_cast<float>(std::abs(left(y, x) - grey));
    }
  }
  return error;
}

void Values::add(const cv::Mat1f& image) {
  std::copy_if(image.begin(), image.end(), std::back_inserter(values_),
               [](float value) { return !std::isnan(value); });
}

double Values::mean() const { return mean_of(values_); }

double Values::median() const {
  std::vector<float> values = values_;
  return lower_median(values);
}

BoardMeasures measure_board(const Corners& corners, cv::Size board, const cv::Mat1w& disparity,
                            const Reprojection& reprojection) {
  cv::Mat1f px;
  to_float(disparity, reprojection.offset, kNone, px);
  px.setTo(kNone, px <= 0);  // has no depth
  const cv::Mat1b mask = inside(corners, px.size());
  std::vector<cv::Vec3d> points;
  for (int y = 0; y < px.rows; ++y) {
    for (int x = 0; x < px.cols; ++x) {
      if (mask(y, x) == 0 || std::isnan(px(y, x))) continue;
      points.push_back(point(x, y, px(y, x), reprojection));
    }
  }
  BoardMeasures measures;
  measures.coverage = 100.0 * static_cast<double>(points.size()) / cv::countNonZero(mask);
  std::vector<double> distances = plane_distances(points);
  measures.rms_distance =
      std::sqrt(std::inner_product(distances.begin(), distances.end(), distances.begin(), 0.0) /
                static_cast<double>(distances.size()));
  measures.median_distance = lower_median(distances);

  std::vector<std::optional<cv::Vec3d>> corner_points;
  int found = 0;
  for (const cv::Point2f& corner : corners) {
    const double d = corner_disparity(px, corner);
    corner_points.emplace_back();
    if (std::isnan(d)) continue;
    corner_points.back() = point(corner.x, corner.y, d, reprojection);
    ++found;
  }
  measures.corners = 100.0 * found / static_cast<double>(corners.size());
  measures.pitch = mean_of(pitches(corner_points, board));
  return measures;
}

}  // namespace fpga_stereo::tools
