// One frame on its way out, whoever made it: the seam between sources and outputs.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>
#include <std_msgs/Header.h>

#include <opencv2/core.hpp>

#include "fpga_stereo/core/pipeline.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo {

/// The pictures of one camera that somebody listens to.
struct CameraDemand {
  bool mono = false, color = false;       // as the camera sees
  bool rect = false, rect_color = false;  // rectified

  bool any() const { return mono || color || rect || rect_color; }
};

/// What somebody listens to; a source makes nothing else.
struct Demand {
  CameraDemand left, right;
  bool disparity = false;

  bool any() const { return left.any() || right.any() || disparity; }
};

/// The pictures of one camera; those not asked for may be empty. mono and rect are 8UC1, color and
/// rect_color 8UC3 bgr, or 8UC1 where the camera sees grey.
struct CameraImages {
  std_msgs::Header header;  // stamp of the pair, frame_id of this camera's image
  cv::Mat mono, color, rect, rect_color;
  sensor_msgs::ImageConstPtr raw;  // the camera's message, where one came; mono may be its pixels
};

/// What a source made of one pair of images.
struct StereoFrame {
  CameraImages left, right;
  sensor_msgs::CameraInfo left_info;
  StereoGeometry geometry;
  Settings settings;    // that it was made with
  cv::Mat1w disparity;  // 1/32 px, kNoDisparity = none; empty where not asked for
  StageTimes ms{};
  double arrived = 0;  // s, wall time at which the last byte came from a board; 0: from none
};

}  // namespace fpga_stereo
