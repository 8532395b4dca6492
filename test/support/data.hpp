// The images on disk that tests use and the project does not contain. Tests skip without them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo::test {

/// $FPGA_STEREO_DATA, else the folder given when building; none where there is no such folder.
std::optional<std::string> data_dir();

/// What a skipped test says.
extern const char* const kNoData;

// The loaders below need data_dir() and throw std::runtime_error for a file that is missing.

struct ImagePair {
  cv::Mat1b left, right;
};

struct CalibrationPair {
  CameraCalibration left, right;
};

/// A pair of the Middlebury stereo evaluation, version 2, with its truth.
struct MiddleburyPair {
  std::string name;
  cv::Mat1b left, right;
  cv::Mat1f truth;              // px; 0 = unknown
  cv::Mat1b nonocc, all, disc;  // 255 = evaluated
  int disparity_range = 0;      // of the benchmark, rounded up to an allowed one
};

/// tsukuba, venus, teddy, cones.
const std::vector<std::string>& middlebury_names();
MiddleburyPair middlebury_pair(const std::string& name);

/// EuRoC MAV V1_01_easy: raw frames 0 .. kEurocFrames - 1.
constexpr int kEurocFrames = 12;
ImagePair euroc_pair(int index);
/// From sensor.yaml by cv::stereoRectify, zero disparity, alpha 0.
CalibrationPair euroc_calibration();

/// Chessboard of the OpenCV samples: raw frames 1 .. 9 and 11 .. 14.
ImagePair chessboard_pair(int number);
CalibrationPair chessboard_calibration();

}  // namespace fpga_stereo::test
