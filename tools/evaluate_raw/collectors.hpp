// Collects the measures of all contenders over the pairs of a folder.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "evaluate_raw/measures.hpp"

namespace fpga_stereo::tools {

/// A raw pair and its rectified images, without the shift by min_disparity.
struct Images {
  cv::Mat1b left_raw, right_raw, left, right;
};

/// How well each contender predicts the left images of a sequence.
class Predictions {
 public:
  static constexpr const char* kTitles[] = {"coverage %", "mean", "median", "mean, common",
                                            "median, common"};

  Predictions(std::size_t num_contenders, int min_disparity);

  /// Adds the disparities that the contenders found for a pair.
  void add(const Images& images, const std::vector<cv::Mat1w>& disparities);
  /// Returns the values of a contender, in the order of the titles.
  std::vector<double> values(std::size_t contender) const;

 private:
  std::vector<Values> all_, common_;  // by contender
  std::vector<double> covered_;       // pixels with a disparity
  double total_ = 0;                  // pixels
  const int min_disparity_;
};

/// The mean measures of chessboards.
class Boards {
 public:
  static constexpr const char* kTitles[] = {"coverage %", "RMS mm", "median mm", "corners %",
                                            "pitch error %"};

  /// `square` is the side of a square, m.
  Boards(std::size_t num_contenders, cv::Size board, double square,
         const Reprojection& reprojection);

  /// Adds the disparities that the contenders found for a pair. Returns false if its left image
  /// shows no chessboard.
  bool add(const Images& images, const std::vector<cv::Mat1w>& disparities);
  /// Returns the values of a contender, in the order of the titles.
  std::vector<double> values(std::size_t contender) const;

 private:
  std::vector<std::vector<double>> sums_;  // by contender and title
  std::vector<std::vector<int>> counts_;
  const cv::Size board_;
  const double square_;
  const Reprojection reprojection_;
};

}  // namespace fpga_stereo::tools
