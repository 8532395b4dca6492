// The settings of the board, read once at the start of the node.
#pragma once

#include <ros/node_handle.h>

#include <opencv2/core.hpp>
#include <string>

#include "ros/parameter_reader.hpp"

namespace fpga_stereo {

enum class Backend {
  kAuto,      // the board if one is connected and able, otherwise the software pipeline
  kBoard,     // only the board
  kSoftware,  // only the software pipeline; the node looks for no board
};

struct BoardSettings {
  Backend backend = Backend::kAuto;
  /// As for link::open_transport(). A bad name is kept: the node must not use another board.
  std::string device = "usb";
  bool topic_input = false;       // the board computes pairs from topics, not from its cameras
  cv::Size image_size{640, 480};  // px, of the board's cameras until they are calibrated
  std::string frame_id;           // of the board's images
  /// Calibration files. Empty: CalibrationStore's default for a board, the topic camera_info for
  /// images from topics.
  std::string left_url, right_url;
  double mid_exposure_ms = 0;    // from mid-exposure to the first pixel
  int frame_interval = 1;        // the board sends every n-th pair of its cameras
  int verify = 0;                // the software verifies every n-th frame; 0: none
  bool keep_incomplete = false;  // publish frames that lack up to half of their rows
};

/// True if the device is a recording of a link.
bool is_recording(const BoardSettings& settings);

/// Reads ~backend, ~device, ~serial_number, ~board_input, ~image_width, ~image_height, ~frame_id,
/// ~left_info_url, ~right_info_url, ~mid_exposure, ~frame_interval, ~verify, ~keep_incomplete.
BoardSettings load_board_settings(const ros::NodeHandle& private_nh, ParameterReport& report);

}  // namespace fpga_stereo
