// Sources of the stereo pairs of a bag.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "make_bag/stereo_info.hpp"
#include "support/euroc.hpp"

namespace fpga_stereo::tools {

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

/// Reads a folder as read_euroc_folder() does.
StereoSource read_euroc(const std::string& folder);

}  // namespace fpga_stereo::tools
