// The rectification mesh of a camera: where each pixel of the rectified image comes from.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// Shifting a source position right by this gives whole px, rounded towards minus infinity.
constexpr int kSourceShift = 5;
static_assert(kSourceScale == 1 << kSourceShift);

/// Displacements, source minus destination, at every 8th pixel of the rectified image. Node (i, j)
/// lies at pixel (8 i, 8 j). One node lies past the last pixel, so that every pixel has a whole
/// cell.
struct Mesh {
  cv::Size size;              // of the rectified image, px
  cv::Mat_<cv::Vec2s> nodes;  // (dx, dy) in 1/128 px

  /// Returns the number of nodes for an image of this size: ceil(W / 8) + 1 by ceil(H / 8) + 1.
  static cv::Size node_count(cv::Size size);
  /// Returns a mesh that shifts the image by whole pixels: rectified(x) = raw(x + shift_x).
  static Mesh shift(cv::Size size, int shift_x);
};

/// The source positions of a row of the rectified image. Interpolates bilinearly between nodes in
/// exact integers: first down the columns (1/1024 px), then along the row (1/8192 px), then rounds
/// half up to 1/32 px.
class MeshRow {
 public:
  MeshRow(const Mesh& mesh, int y);
  /// Returns the source of pixel (x, y) in the raw image, in 1/32 px.
  cv::Point source(int x) const;
  /// The displacements at (8 i, y), in 1/1024 px.
  const std::vector<cv::Point>& columns() const { return columns_; }

 private:
  int y_;
  std::vector<cv::Point> columns_;
};

}  // namespace fpga_stereo
