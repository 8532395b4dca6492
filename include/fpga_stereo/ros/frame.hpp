// One frame on its way out, whoever made it: the seam between sources and outputs.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>

#include <opencv2/core.hpp>

#include "fpga_stereo/core/pipeline.hpp"
#include "fpga_stereo/ros/settings.hpp"

namespace fpga_stereo {

/// What somebody listens to; a source makes nothing else.
struct Demand {
  bool left_rect = false, right_rect = false;
  bool left_color = false, right_color = false;
  bool disparity = false;

  bool any() const { return left_rect || right_rect || left_color || right_color || disparity; }
};

/// What a source made of one pair of images. What was not asked for is empty.
struct StereoFrame {
  std_msgs::Header header;        // stamp of the pair, frame_id of the left image
  std_msgs::Header right_header;  // the same stamp, frame_id of the right image
  sensor_msgs::CameraInfo left_info;
  StereoGeometry geometry;
  Settings settings;                // that it was made with
  cv::Mat left_rect, right_rect;    // 8UC1
  cv::Mat left_color, right_color;  // 8UC3 bgr, or 8UC1 where the camera sees grey
  cv::Mat1w disparity;              // 1/32 px, kNoDisparity = none
  StageTimes ms{};
};

}  // namespace fpga_stereo
