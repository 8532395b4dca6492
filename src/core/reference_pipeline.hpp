// Runs the scalar stages, which are normative, and keeps the output of every stage. Slow.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "core/stages.hpp"
#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/pipeline.hpp"

namespace fpga_stereo {

/// The output of every stage for an image pair. Valid until the next pair is processed.
struct Taps {
  cv::Mat1b left, right;          // rectified; right is shifted by min_disparity
  cv::Mat left_bits, right_bits;  // census
  Selection selection;
  cv::Mat1b kept;
  cv::Mat1w refined;   // output of subpixel
  cv::Mat1w filtered;  // output of speckle
  cv::Mat1w filled;    // output of fill; empty unless dense
  // The result, which is the output of the last stage: 1/32 px; kNoDisparity if invalid.
  cv::Mat1w disparity;
  StageTimes ms{};
};

class ReferencePipeline {
 public:
  /// Runs every stage on up to `num_threads` (>= 1) threads of OpenCV's pool. Results do not depend
  /// on the number of threads. The images must pass validate_image().
  const Taps& process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                      const StereoRectification& rectification, const Parameters& parameters,
                      int num_threads);

 private:
  void match_and_select(const Parameters& parameters, int num_threads);
  void aggregate_and_select(const Parameters& parameters);

  Taps taps_;
  std::vector<Match> matches_;  // one per band
  Cost cost_;
  Aggregate aggregate_;
};

}  // namespace fpga_stereo
