// What a board sends as what the node publishes. A board's numbers are checked before they are
// used.
#pragma once

#include <ros/time.h>
#include <std_msgs/Header.h>

#include "fpga_stereo/core/result.hpp"
#include "fpga_stereo/link/frame_set.hpp"
#include "ros/board_plan.hpp"
#include "ros/frame.hpp"
#include "ros/topic_input.hpp"

namespace fpga_stereo {

/// `seconds` of the host's time; refuses what no ros::Time can hold.
Result<ros::Time> to_stamp(double seconds);

/// Whether all images of a set have the size that the board was told.
Status check_sizes(const link::FrameSet& set, cv::Size size);

/// The frame of a pair that was sent to the board. Refuses sets without disparity, and pairs of
/// another calibration than `made`.
Result<StereoFrame> frame_of_pair(const link::ReceivedFrames& received, const BoardPlan::Made& made,
                                  const InputPair& pair, const Demand& demand);

/// The frame of the board's own cameras: nothing but raw images where `made` has no rectification.
StereoFrame frame_of_cameras(const link::ReceivedFrames& received, const BoardPlan::Made& made,
                             const Demand& demand, const std_msgs::Header& header);

/// The raw images of the board's own cameras, for the software. Refuses sets that lack one.
Result<InputPair> raw_pair(const link::FrameSet& set, const BoardPlan::Made& made,
                           const std_msgs::Header& header);

}  // namespace fpga_stereo
