// Pairs and rectifications that tests of whole pipelines share.
#pragma once

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {

inline StereoRectification unmoved(cv::Size size, int min_disparity = 0) {
  StereoGeometry geometry;
  geometry.image_size = size;
  return identity_rectification(geometry, min_disparity);
}

/// Meshes that move every pixel by up to `most` / 128 px.
inline StereoRectification bent(cv::Size size, unsigned seed, int most = 300) {
  StereoRectification r = unmoved(size);
  cv::RNG rng(seed);
  rng.fill(r.left.mesh.nodes, cv::RNG::UNIFORM, -most, most);
  rng.fill(r.right.mesh.nodes, cv::RNG::UNIFORM, -most, most);
  return r;
}

/// A pair with structure: a slanted plane, so that some pixels pass the checks.
inline SlantedPair textured(cv::Size size, unsigned seed) {
  return slanted_pair(size, Texture(seed), 3.2, 0.05);
}

}  // namespace fpga_stereo::test
