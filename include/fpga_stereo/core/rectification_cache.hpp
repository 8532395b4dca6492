// Keeps the rectification of a camera pair from frame to frame.
#pragma once

#include <memory>
#include <optional>

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/result.hpp"

namespace fpga_stereo {

/// Makes the rectification of a pair, and makes it again only when the calibration or min_disparity
/// changes: that takes about as long as a frame. Not thread-safe.
class RectificationCache {
 public:
  using Rectification = Result<std::shared_ptr<const StereoRectification>>;

  /// Returns the rectification, or the error of make_stereo_rectification(). The reference is valid
  /// until the next call. Equal arguments in a row return the same pointer.
  const Rectification& get(const StereoCalibration& calibration, int min_disparity);

 private:
  StereoCalibration calibration_;
  int min_disparity_ = 0;
  std::optional<Rectification> rectification_;
};

}  // namespace fpga_stereo
