// Makes frames from raw pairs, for the software and for boards.
#pragma once

#include "fpga_stereo/core/result.hpp"
#include "ros/demand.hpp"
#include "ros/source_pair.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// Returns a frame with the raw images, headers, calibration and settings of the pair, without
/// geometry, rectified images and disparity.
StereoFrame make_raw_frame(const SourcePair& pair, const Settings& settings);

/// Refuses a pair whose images the rectification was not made for.
Status check_pair_size(const RawPair& pair, const StereoRectification& rectification);

/// Rectifies the raw images of the frame that are in demand and not rectified yet.
void add_rectified_images(const StereoRectification& rectification, const Demand& demand,
                          StereoFrame& frame);

}  // namespace fpga_stereo
