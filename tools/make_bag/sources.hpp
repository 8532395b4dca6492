// Sources of the stereo pairs of a bag.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "make_bag/stereo_info.hpp"

namespace fpga_stereo::tools {

struct FramePaths {
  std::int64_t stamp_ns = 0;
  std::string left, right;  // image files
};

struct StereoSource {
  std::vector<FramePaths> frames;  // by ascending stamp, at least one
  std::int64_t duration_ns = 0;    // period of a repetition
  StereoInfo info;
};

/// Pairs the n-th left with the n-th right image. The first stamp is `start` s; `rate` is in pairs
/// per second. Leaves the calibration empty. Throws std::runtime_error if the numbers of images
/// differ.
StereoSource pair_files(const std::vector<std::string>& left, const std::vector<std::string>& right,
                        double rate, double start);

/// Reads a folder of the EuRoC MAV dataset (M. Burri et al., IJRR 35, 2016): cam0 and cam1, each
/// with sensor.yaml and data/<time in ns>.png. Reports images without a partner on stderr and skips
/// them. Throws std::runtime_error with the file that cannot be used.
StereoSource read_euroc(const std::string& folder);

}  // namespace fpga_stereo::tools
