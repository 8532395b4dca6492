// What the node's parameters say about a board; read once at the start.
#pragma once

#include <ros/node_handle.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace fpga_stereo {

enum class Backend {
  kAuto,      // the board where there is one, else the software pipeline
  kBoard,     // the board and nothing else
  kSoftware,  // no board is looked for
};

struct BoardSettings {
  Backend backend = Backend::kAuto;
  std::string device = "usb";     // as link::open_transport() takes it
  bool topic_input = false;       // the board's images come from topics, not from its cameras
  cv::Size image_size{640, 480};  // px, of cameras that are not calibrated
  std::string frame_id = "stereo_left_optical_frame";
  std::string left_url, right_url;  // of the calibration; empty: camera_info_manager's default
  double mid_exposure_ms = 0;       // from the middle of the exposure to the first pixel
  int frame_interval = 1;           // one pair in so many is sent
  int verify = 0;                   // one frame in so many is computed in software, too; 0: none
  bool keep_incomplete = false;     // publish frames that lack rows, these without disparity
};

/// Reads ~backend, ~device, ~serial_number, ~board_input, ~image_width, ~image_height, ~frame_id,
/// ~left_info_url, ~right_info_url, ~mid_exposure, ~frame_interval, ~verify, ~keep_incomplete.
/// What is refused keeps its default and is named in `refusals`.
BoardSettings load_board_settings(const ros::NodeHandle& private_nh,
                                  std::vector<std::string>& refusals);

}  // namespace fpga_stereo
