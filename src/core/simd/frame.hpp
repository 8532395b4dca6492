// A frame by the SIMD kernels: the stages in data order, over bands of rows.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/regions.hpp"
#include "core/simd/row_matcher.hpp"
#include "core/simd/source_table.hpp"
#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo::simd {

class Frame {
 public:
  void process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
               const StereoRectification& rectification, const Parameters& parameters,
               int num_threads, DisparityFrame& out);

 private:
  struct Band {
    RowMatcher matcher;
    std::vector<std::uint8_t> kept;
    StageTimes ms{};
  };
  struct Camera {
    cv::Mat1b padded, rectified;  // with and without the border
    SourceTable sources;
    CensusPlanes bits;
  };

  void create(cv::Size size, const Parameters& p, int num_threads);
  void census(Camera& camera, cv::Range rows);
  void share_time(double wall, StageTimes& ms) const;
  void disparity_rows(const Parameters& p, cv::Range rows, Band& band);

  std::vector<cv::Point> neighbours_;      // of a census window
  std::vector<std::ptrdiff_t> distances_;  // to them, bytes
  Camera left_, right_;
  cv::Mat1w padded_disparity_, disparity_;
  std::vector<Band> bands_;
  Regions regions_;
};

}  // namespace fpga_stereo::simd
