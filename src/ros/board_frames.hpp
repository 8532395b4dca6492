// Makes frames from what a board sends. Checks the board's numbers before it uses them.
#pragma once

#include <ros/time.h>

#include <string>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/board_plan.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "ros/demand.hpp"
#include "ros/source_pair.hpp"
#include "ros/stereo_frame.hpp"

namespace fpga_stereo {

/// Converts a stamp in s of the host's time. Refuses one that ros::Time cannot hold.
Result<ros::Time> to_stamp(double seconds);

/// Refuses a set with an image that is not of this size.
Status check_sizes(const link::FrameSet& set, cv::Size size);

/// Refuses a set without a raw left and right image.
Status check_raw_images(const link::FrameSet& set);

/// Returns the raw images of the board's cameras, those that came, with the calibration that was
/// planned. The pair shares the pixels of the set.
SourcePair camera_pair(const link::FrameSet& set, const link::PlannedConfiguration& planned,
                       const ros::Time& stamp, const std::string& frame_id, std::uint64_t number);

/// Returns the frame that the board made of a pair that the host sent. Refuses a set without
/// disparity and a pair with another calibration than the planned one.
Result<StereoFrame> frame_of_host_pair(const link::ReceivedFrames& received,
                                       const link::PlannedConfiguration& planned,
                                       const SourcePair& pair, const Settings& settings,
                                       const Demand& demand);

/// Returns the frame that the board made of a pair of its own cameras: without images, if the
/// planned configuration has no rectification.
StereoFrame frame_of_camera_pair(const link::ReceivedFrames& received,
                                 const link::PlannedConfiguration& planned, const SourcePair& pair,
                                 const Settings& settings, const Demand& demand);

}  // namespace fpga_stereo
