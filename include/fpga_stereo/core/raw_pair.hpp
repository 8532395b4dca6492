// The input of the pipeline: one image of each camera, decoded, with calibration and stamp.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo {

/// A left and a right image with one stamp. Whoever receives images (a topic callback, a board)
/// decodes them once into this struct; every later step uses it as it is.
///
/// Copies share the pixels. The pixels belong to the cv::Mat, unless whoever made the pair says
/// that they lie in other memory.
struct RawPair {
  cv::Mat1b left, right;  // grey
  // 8UC3 BGR; the grey image itself if the camera is grey; empty if nobody asked for colour.
  cv::Mat left_color, right_color;
  StereoCalibration calibration;
  std::int64_t stamp_ns = 0;  // ns since 1970: the middle of the exposure
  std::string left_frame_id, right_frame_id;
};

}  // namespace fpga_stereo
