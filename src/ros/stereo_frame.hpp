// The result for one pair: what sources hand to the outputs, whichever source made it.
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <opencv2/core.hpp>

#include "fpga_stereo/core/pipeline.hpp"
#include "ros/settings.hpp"

namespace fpga_stereo {

/// The rectified images of one camera; empty if not in demand. rect is 8UC1; rect_color is 8UC3
/// BGR, or 8UC1 if the camera is grey.
struct CameraImages {
  std_msgs::Header header;  // of this camera's image
  cv::Mat rect, rect_color;
};

/// Everything a source made of one pair.
///
/// The source owns the pixels: the software pipeline writes its next frame into the same memory.
/// They are valid until the callback that receives the frame returns; own_pixels() makes them last.
struct StereoFrame {
  CameraImages left, right;
  sensor_msgs::CameraInfoConstPtr left_info;
  StereoGeometry geometry;
  Settings settings;         // the settings that the frame was made with
  cv::Mat1w disparity;       // 1/32 px; kNoDisparity: invalid
  StageTimes ms{};           // of the software pipeline; 0 if a board made the disparity
  double arrived = 0;        // s, wall time of the board's last byte; 0: made by the software
  std::uint64_t number = 0;  // of the pair; see SourcePair

  /// Replaces the images that the source will overwrite by copies.
  void own_pixels();
};

}  // namespace fpga_stereo
