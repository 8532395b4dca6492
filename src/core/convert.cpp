#include "fpga_stereo/core/convert.hpp"

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/stages.hpp"

namespace fpga_stereo {
namespace {

/// Returns a table of function(disparity in px) for all values of a disparity image; the entry of
/// kNoDisparity is 0.
template <class T, class Function>
std::vector<T> lookup(Function function) {
  std::vector<T> table(kNoDisparity + 1);
  for (std::size_t value = 0; value < kNoDisparity; ++value) {
    table[value] = function(static_cast<double>(value) / kDisparityScale);
  }
  return table;
}

template <class T>
void apply(const cv::Mat1w& disparity, const std::vector<T>& table, cv::Mat_<T>& out) {
  out.create(disparity.size());
  for (int y = 0; y < disparity.rows; ++y) {
    const std::uint16_t* in = disparity[y];
    T* row = out[y];
    for (int x = 0; x < disparity.cols; ++x) row[x] = table[in[x]];
  }
}

}  // namespace

Reprojection make_reprojection(const StereoGeometry& g, int min_disparity) {
  return {g.fx, g.fy, g.cx, g.cy, g.baseline, min_disparity - (g.cx - g.cx_right)};
}

void to_float(const cv::Mat1w& disparity, double offset, float invalid, cv::Mat1f& out) {
  out.create(disparity.size());
  for (int y = 0; y < disparity.rows; ++y) {
    const std::uint16_t* in = disparity[y];
    float* row = out[y];
    for (int x = 0; x < disparity.cols; ++x) {
      const auto value = static_cast<float>(static_cast<double>(in[x]) / kDisparityScale + offset);
      row[x] = in[x] == kNoDisparity ? invalid : value;
    }
  }
}

void to_depth(const cv::Mat1w& disparity, const Reprojection& r, cv::Mat1f& out) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  auto table = lookup<float>([&](double value) {
    const auto depth = static_cast<float>(r.fx * r.baseline / (value + r.offset));
    return depth > 0 && std::isfinite(depth) ? depth : kNone;
  });
  table[kNoDisparity] = kNone;
  apply(disparity, table, out);
}

void to_depth(const cv::Mat1w& disparity, const Reprojection& r, cv::Mat1w& out) {
  auto table = lookup<std::uint16_t>([&](double value) -> std::uint16_t {
    const double d = value + r.offset;
    const double millimetres = d > 0 ? std::round(1000 * r.fx * r.baseline / d) : 0;
    return millimetres <= 0xFFFF ? static_cast<std::uint16_t>(millimetres) : 0;
  });
  apply(disparity, table, out);
}

void to_color(const cv::Mat1w& disparity, int disparity_range, cv::Mat3b& out) {
  cv::Mat1b grey;
  disparity.convertTo(grey, CV_8U, 255.0 / (kDisparityScale * (disparity_range - 1)));
  cv::applyColorMap(grey, out, cv::COLORMAP_TURBO);
  out.setTo(cv::Scalar::all(0), disparity == kNoDisparity);
}

}  // namespace fpga_stereo
