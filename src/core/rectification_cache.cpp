#include "fpga_stereo/core/rectification_cache.hpp"

#include <utility>

namespace fpga_stereo {

const RectificationCache::Rectification& RectificationCache::get(
    const StereoCalibration& calibration, int min_disparity) {
  if (rectification_ && min_disparity_ == min_disparity && calibration_ == calibration) {
    return *rectification_;
  }
  calibration_ = calibration;
  min_disparity_ = min_disparity;
  auto made = make_stereo_rectification(calibration.left, calibration.right, min_disparity);
  if (made) {
    rectification_.emplace(std::make_shared<const StereoRectification>(std::move(*made)));
  } else {
    rectification_.emplace(made.error());
  }
  return *rectification_;
}

}  // namespace fpga_stereo
