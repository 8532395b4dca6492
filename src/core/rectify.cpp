#include <opencv2/core.hpp>

#include "core/rectify_pixels.hpp"
#include "core/stages.hpp"

namespace fpga_stereo {

void rectify(const cv::Mat& raw, const Mesh& mesh, cv::Range rows, cv::Mat& rectified) {
  CV_Assert(raw.type() == CV_8UC1 || raw.type() == CV_8UC3);
  rectified.create(mesh.size, raw.type());
  if (rows == cv::Range::all()) rows = {0, mesh.size.height};
  for (int y = rows.start; y < rows.end; ++y) {
    const MeshRow mesh_row(mesh, y);
    if (raw.channels() == 1) {
      rectify_pixels<1>(raw, mesh_row, 0, mesh.size.width, rectified.ptr(y));
    } else {
      rectify_pixels<3>(raw, mesh_row, 0, mesh.size.width, rectified.ptr(y));
    }
  }
}

}  // namespace fpga_stereo
