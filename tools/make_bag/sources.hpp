// Where the stereo pairs of a bag come from.
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
  std::vector<FramePaths> frames;  // in order of time, at least one
  std::int64_t duration_ns = 0;    // from the first frame to the first one of a repetition
  StereoInfo info;
};

/// Pairs the n-th left with the n-th right image, `rate` pairs per second from `start` seconds on.
/// The calibration is not filled in. Throws std::runtime_error if the numbers differ.
StereoSource pair_files(const std::vector<std::string>& left, const std::vector<std::string>& right,
                        double rate, double start);

/// A folder of the EuRoC MAV dataset (M. Burri et al., IJRR 35, 2016): cam0 and cam1, each with
/// sensor.yaml and data/<time in ns>.png. Pairs that lack one side are named and left out. Throws
/// std::runtime_error that names what cannot be used.
StereoSource read_euroc(const std::string& folder);

}  // namespace fpga_stereo::tools
