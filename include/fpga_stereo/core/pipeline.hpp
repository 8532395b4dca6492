// The stereo pipeline in software: computes disparities from raw image pairs, with the SIMD
// instructions of target() and several threads. The result is the same for all of these.
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

/// The results for an image pair. Images belong to the Pipeline and are valid until its next call.
struct DisparityFrame {
  cv::Mat1b left, right;  // rectified; right is shifted by min_disparity
  cv::Mat1w disparity;    // 1/32 px from min_disparity; kNoDisparity if invalid
  StageTimes ms{};
};

/// Refuses a raw image of another size than that of the rectification, or larger than kMaxWidth x
/// kMaxHeight. `camera` names the camera in errors.
Status validate_image(const cv::Mat& raw, const StereoRectification& rectification,
                      const std::string& camera);

/// Rectifies an image (8UC1 or 8UC3) by `mesh`, which decides on the size of `rectified`. Uses the
/// instructions of target() and up to `num_threads` (>= 1) threads of OpenCV's pool.
void rectify_image(const cv::Mat& raw, const Mesh& mesh, int num_threads, cv::Mat& rectified);

/// Runs every stage on image pairs. Keeps its memory from pair to pair. Not thread-safe.
class Pipeline {
 public:
  Pipeline();
  ~Pipeline();

  /// Computes the disparities of a pair, whose images must pass validate_image() and whose
  /// parameters validate(). Uses up to `num_threads` (>= 1) threads of OpenCV's pool.
  const DisparityFrame& process(const cv::Mat1b& left_raw, const cv::Mat1b& right_raw,
                                const StereoRectification& rectification,
                                const Parameters& parameters, int num_threads);

 private:
  struct Implementation;

  std::unique_ptr<Implementation> implementation_;
  DisparityFrame frame_;
};

}  // namespace fpga_stereo
