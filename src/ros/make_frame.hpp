// Makes frames from raw pairs, for the software and for boards.
#pragma once

#include "fpga_stereo/core/result.hpp"
#include "ros/demand.hpp"
#include "ros/source_pair.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// Returns a frame with the headers, calibration and settings of the pair, without geometry and
/// images.
StereoFrame make_empty_frame(const SourcePair& pair, const Settings& settings);

/// Refuses a pair whose images the rectification was not made for.
Status check_pair_size(const RawPair& pair, const StereoRectification& rectification);

/// Adds the rectified images that are in demand and not in the frame yet.
void add_rectified_images(const RawPair& pair, const StereoRectification& rectification,
                          const Demand& demand, StereoFrame& frame);

}  // namespace fpga_stereo
