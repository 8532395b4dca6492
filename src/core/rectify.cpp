#include <opencv2/core.hpp>

#include "fpga_stereo/core/stages.hpp"

namespace fpga_stereo {
namespace {

constexpr int kOne = kSourceScale;  // what the weights of two neighbours add up to

/// Bilinear over 2 x 2, rounded half up; a pixel outside the raw image is 0.
template <int kChannels>
void rectify_row(const cv::Mat& raw, const MeshRow& mesh, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const cv::Point source = mesh.source(x);
    const int left = source.x >> kSourceShift;
    const int top = source.y >> kSourceShift;
    const int wx = source.x & (kOne - 1);
    const int wy = source.y & (kOne - 1);
    for (int channel = 0; channel < kChannels; ++channel) {
      const auto tap = [&](int tap_x, int tap_y) -> int {
        const bool inside = tap_x >= 0 && tap_x < raw.cols && tap_y >= 0 && tap_y < raw.rows;
        return inside ? raw.ptr(tap_y)[tap_x * kChannels + channel] : 0;
      };
      const int sum = (kOne - wy) * ((kOne - wx) * tap(left, top) + wx * tap(left + 1, top)) +
                      wy * ((kOne - wx) * tap(left, top + 1) + wx * tap(left + 1, top + 1));
      out[x * kChannels + channel] =
          static_cast<std::uint8_t>((sum + kOne * kOne / 2) >> (2 * kSourceShift));
    }
  }
}

}  // namespace

void rectify(const cv::Mat& raw, const Mesh& mesh, cv::Range rows, cv::Mat& rectified) {
  CV_Assert(raw.type() == CV_8UC1 || raw.type() == CV_8UC3);
  rectified.create(mesh.size, raw.type());
  if (rows == cv::Range::all()) rows = {0, mesh.size.height};
  for (int y = rows.start; y < rows.end; ++y) {
    const MeshRow mesh_row(mesh, y);
    if (raw.channels() == 1) {
      rectify_row<1>(raw, mesh_row, mesh.size.width, rectified.ptr(y));
    } else {
      rectify_row<3>(raw, mesh_row, mesh.size.width, rectified.ptr(y));
    }
  }
}

}  // namespace fpga_stereo
