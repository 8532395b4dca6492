#include "make_bag/sources.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace fpga_stereo::tools {
namespace {

constexpr double kNsPerSecond = 1e9;

}  // namespace

StereoSource pair_files(const std::vector<std::string>& left, const std::vector<std::string>& right,
                        double rate, double start) {
  if (left.size() != right.size()) {
    throw std::runtime_error(
        fmt::format("--left gives {} images and --right {}: the numbers must be equal", left.size(),
                    right.size()));
  }
  const auto stamp = [&](std::size_t i) {
    return std::llround(start * kNsPerSecond) +
           std::llround(static_cast<double>(i) * kNsPerSecond / rate);
  };
  StereoSource source;
  for (std::size_t i = 0; i < left.size(); ++i) {
    source.frames.push_back({stamp(i), left[i], right[i]});
  }
  source.duration_ns = stamp(left.size()) - stamp(0);
  return source;
}

StereoSource read_euroc(const std::string& folder) {
  EurocFolder euroc = read_euroc_folder(folder, "make_bag");
  StereoSource source;
  source.frames = std::move(euroc.frames);
  const auto count = static_cast<std::int64_t>(source.frames.size());
  const std::int64_t span = source.frames.back().stamp_ns - source.frames.front().stamp_ns;
  constexpr std::int64_t kSingleFrameNs = 100'000'000;
  source.duration_ns = count > 1 ? span + span / (count - 1) : kSingleFrameNs;
  source.info = to_info(euroc.calibration);
  return source;
}

}  // namespace fpga_stereo::tools
