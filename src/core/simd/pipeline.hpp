// The pipeline on SIMD instructions: runs the stages of stages.hpp over bands of rows.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "core/simd/stages.hpp"
#include "core/simd/turns.hpp"
#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo::simd {

class Pipeline {
 public:
  /// See fpga_stereo::Pipeline. The images of `out` belong to this object and are valid until the
  /// next call.
  void process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
               const StereoRectification& rectification, const Parameters& p, int num_threads,
               DisparityFrame& out);

 private:
  struct Camera {
    SourceTable sources;
    CensusImage rectified;
    CensusPlanes bits;
  };
  /// What a thread needs for its band of rows.
  struct Band {
    Match match;
    SelectionBuffer selection;
    std::vector<std::uint8_t> kept;
    // For semi-global matching, of the rows that are processed together.
    Cost cost;
    int next_cost_row = -1;
    cv::Mat1b costs;
    // Two sets take turns: the last row of one is read while the next rows are computed.
    std::vector<VerticalCosts> vertical_costs[2];
    int set = 0;
    HorizontalPaths horizontal_paths;
    PathSumsBuffer sums;
    Fit fit;
    StageTimes ms{};  // of the rows that are timed
  };

  void create(cv::Size size, const Parameters& p, int num_threads);
  void match_to_subpixel(const Parameters& p, cv::Range rows, Band& band);
  void cost_to_subpixel(const Parameters& p, int num_threads, StageTimes& ms);
  void cost_to_check(const Parameters& p, cv::Range rows, int part, Band& band);
  void share_time(double wall, StageTimes& ms) const;

  Camera left_, right_;
  std::vector<Band> bands_;
  DisparityImage disparity_;
  SpeckleFilter speckle_;
  // For semi-global matching.
  GuideImage guide_;
  VerticalPaths vertical_paths_;         // passed from thread to thread,
  const VerticalCosts* last_ = nullptr;  // with the last row that they have computed
  Turns turns_;
  ByteImage winner_, kept_;
  DisparityImage smooth_;  // after the first median
};

}  // namespace fpga_stereo::simd
