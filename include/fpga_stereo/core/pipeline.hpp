// The pipeline in software: all stages, on the instructions of target(), over bands of rows in
// parallel. The same bits as ReferencePipeline.
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// Wall-clock time of each stage in ms, indexed by Stage.
using StageTimes = std::array<double, kNumStages>;

/// What the pipeline makes of a pair. Valid until the next one is processed.
struct DisparityFrame {
  cv::Mat1b left, right;  // rectified; right is shifted by min_disparity
  cv::Mat1w disparity;    // 1/32 px, kNoDisparity = none
  StageTimes ms{};
};

/// Refuses a raw image that the rectification was not made for or that is larger than
/// kMaxWidth x kMaxHeight.
Status validate_image(const cv::Mat& raw, const StereoRectification& rectification,
                      const std::string& camera);

/// rectify on the instructions of target(), over bands of rows, `num_threads` of them.
void rectify_image(const cv::Mat& raw, const Mesh& mesh, int num_threads, cv::Mat& rectified);

class Pipeline {
 public:
  Pipeline();
  ~Pipeline();

  /// Runs every stage. The result does not depend on `num_threads` (>= 1), which limits how many
  /// threads of OpenCV's pool work on the frame. The images must pass validate_image.
  const DisparityFrame& process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                                const StereoRectification& rectification,
                                const Parameters& parameters, int num_threads);

 private:
  struct Implementation;

  std::unique_ptr<Implementation> implementation_;
  DisparityFrame frame_;
};

}  // namespace fpga_stereo
