// The rectification mesh of one camera: where each pixel of the rectified image comes from.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "fpga_stereo/core/spec.hpp"

namespace fpga_stereo {

/// A source position shifted right by this is in whole px, rounded towards minus infinity.
constexpr int kSourceShift = 5;
static_assert(kSourceScale == 1 << kSourceShift);

/// Displacement, source minus destination, at every 8th pixel of the rectified image.
/// Node (i, j) stands at pixel (8 i, 8 j); there is one node past the last pixel, so that every
/// pixel lies in a full cell.
struct Mesh {
  cv::Size size;              // of the rectified image, px
  cv::Mat_<cv::Vec2s> nodes;  // (dx, dy) in 1/128 px

  /// Nodes along and down for an image of this size: ceil(W / 8) + 1 by ceil(H / 8) + 1.
  static cv::Size node_count(cv::Size size);
  /// A mesh that moves nothing but the image by whole pixels: rectified(x) = raw(x + shift_x).
  static Mesh shift(cv::Size size, int shift_x);
};

/// The source positions of one row of the rectified image. Bilinear between nodes in exact
/// integers: first down the columns (1/1024 px), then along the row (1/8192 px), then rounded half
/// up to 1/32 px.
class MeshRow {
 public:
  MeshRow(const Mesh& mesh, int y);
  /// Source of pixel (x, y) in 1/32 px of the raw image.
  cv::Point source(int x) const;
  /// Displacement at (8 i, y), 1/1024 px.
  const std::vector<cv::Point>& columns() const { return columns_; }

 private:
  int y_;
  std::vector<cv::Point> columns_;
};

}  // namespace fpga_stereo
