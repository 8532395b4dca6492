// Frames from raw pairs: what software and board sources have in common.
#pragma once

#include "fpga_stereo/core/result.hpp"
#include "ros/frame.hpp"
#include "ros/topic_input.hpp"

namespace fpga_stereo {

/// Headers, camera_info, geometry, settings and the grey images; no disparity yet. Refuses images
/// that cannot be read and those of another size than the rectification's.
Result<StereoFrame> begin_frame(const InputPair& pair, const StereoRectification& rectification,
                                const Settings& settings);

/// Adds the pictures that somebody listens to and that are not there yet.
Status add_pictures(const InputPair& pair, const StereoRectification& rectification,
                    const Demand& demand, StereoFrame& frame);

}  // namespace fpga_stereo
