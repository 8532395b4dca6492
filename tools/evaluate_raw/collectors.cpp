#include "evaluate_raw/collectors.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "fpga_stereo/core/convert.hpp"

namespace fpga_stereo::tools {
namespace {

/// Sets every pixel to kNone that is kNone in one of the images.
void keep_common(std::vector<cv::Mat1f>& images) {
  for (int y = 0; y < images[0].rows; ++y) {
    for (int x = 0; x < images[0].cols; ++x) {
      const bool is_common =
          std::none_of(images.begin(), images.end(),
                       [&](const cv::Mat1f& image) { return std::isnan(image(y, x)); });
      if (is_common) continue;
      for (cv::Mat1f& image : images) image(y, x) = kNone;
    }
  }
}

}  // namespace

Predictions::Predictions(std::size_t num_contenders, int min_disparity)
    : all_(num_contenders),
      common_(num_contenders),
      covered_(num_contenders),
      min_disparity_(min_disparity) {}

void Predictions::add(const Images& images, const std::vector<cv::Mat1w>& disparities) {
  const cv::Mat1f right = match_brightness(images.left, images.right);
  std::vector<cv::Mat1f> errors;
  for (std::size_t i = 0; i < disparities.size(); ++i) {
    cv::Mat1f px;
    to_float(disparities[i], min_disparity_, kNone, px);
    errors.push_back(prediction_error(images.left, right, px));
    all_[i].add(errors.back());
    covered_[i] += cv::countNonZero(disparities[i] != kNoDisparity);
  }
  keep_common(errors);
  for (std::size_t i = 0; i < errors.size(); ++i) common_[i].add(errors[i]);
  total_ += static_cast<double>(images.left.total());
}

std::vector<double> Predictions::values(std::size_t i) const {
  return {100 * covered_[i] / total_, all_[i].mean(), all_[i].median(), common_[i].mean(),
          common_[i].median()};
}

Boards::Boards(std::size_t num_contenders, cv::Size board, double square,
               const Reprojection& reprojection)
    : sums_(num_contenders, std::vector<double>(std::size(kTitles))),
      counts_(num_contenders, std::vector<int>(std::size(kTitles))),
      board_(board),
      square_(square),
      reprojection_(reprojection) {}

bool Boards::add(const Images& images, const std::vector<cv::Mat1w>& disparities) {
  const Corners corners = find_corners(images.left, board_);
  if (corners.empty()) return false;
  for (std::size_t i = 0; i < disparities.size(); ++i) {
    const BoardMeasures m = measure_board(corners, board_, disparities[i], reprojection_);
    constexpr double kMmPerM = 1000;
    const double values[] = {m.coverage, kMmPerM * m.rms_distance, kMmPerM * m.median_distance,
                             m.corners, 100 * std::abs(m.pitch / square_ - 1)};
    for (std::size_t k = 0; k < std::size(values); ++k) {
      if (std::isnan(values[k])) continue;  // nothing to measure
      sums_[i][k] += values[k];
      ++counts_[i][k];
    }
  }
  return true;
}

std::vector<double> Boards::values(std::size_t i) const {
  std::vector<double> means;
  for (std::size_t k = 0; k < std::size(kTitles); ++k) {
    means.push_back(sums_[i][k] / counts_[i][k]);
  }
  return means;
}

}  // namespace fpga_stereo::tools
