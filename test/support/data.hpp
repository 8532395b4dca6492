// Images on disk that tests use but the project does not contain. Tests are skipped without them.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "fpga_stereo/core/calibration.hpp"

namespace fpga_stereo::test {

/// Returns $FPGA_STEREO_DATA, or else the folder given at build time; nullopt if it does not exist.
std::optional<std::string> data_dir();

/// The message of a skipped test.
extern const char* const kNoData;

// The loaders below need data_dir() and throw std::runtime_error if a file is missing.

struct ImagePair {
  cv::Mat1b left, right;
};

struct CalibrationPair {
  CameraCalibration left, right;
};

/// A pair of the Middlebury stereo evaluation, version 2, with its ground truth.
struct MiddleburyPair {
  std::string name;
  cv::Mat1b left, right;
  cv::Mat1f truth;              // px; 0 = unknown
  cv::Mat1b nonocc, all, disc;  // 255 = evaluated
  int disparity_range = 0;      // that of the benchmark, rounded up to an allowed value
};

/// tsukuba, venus, teddy, cones.
const std::vector<std::string>& middlebury_names();
MiddleburyPair middlebury_pair(const std::string& name);

/// EuRoC MAV V1_01_easy: raw pairs 0 .. kEurocFrames - 1.
constexpr int kEurocFrames = 12;
ImagePair euroc_pair(int index);
/// Computed from sensor.yaml by cv::stereoRectify with zero disparity and alpha 0.
CalibrationPair euroc_calibration();

/// Chessboard of the OpenCV samples: raw pairs 1 .. 9 and 11 .. 14.
ImagePair chessboard_pair(int number);
CalibrationPair chessboard_calibration();

}  // namespace fpga_stereo::test
