// Image pairs and rectifications for tests of whole pipelines.
#pragma once

#include "fpga_stereo/core/calibration.hpp"
#include "fpga_stereo/core/parameters.hpp"
#include "support/images.hpp"

namespace fpga_stereo::test {

/// Meshes that move nothing but the right image, by min_disparity.
inline StereoRectification identity_for(cv::Size size, int min_disparity = 0) {
  StereoGeometry geometry;
  geometry.image_size = size;
  return identity_rectification(geometry, min_disparity);
}

/// Meshes with random displacements of up to `max_units` / 128 px.
inline StereoRectification random_rectification(cv::Size size, unsigned seed, int max_units = 300) {
  StereoRectification r = identity_for(size);
  cv::RNG rng(seed);
  rng.fill(r.left.mesh.nodes, cv::RNG::UNIFORM, -max_units, max_units);
  rng.fill(r.right.mesh.nodes, cv::RNG::UNIFORM, -max_units, max_units);
  return r;
}

/// A slanted plane, on which some pixels pass the checks and others do not.
inline SlantedPair textured_pair(cv::Size size, unsigned seed) {
  return slanted_pair(size, Texture(seed), 3.2, 0.05);
}

}  // namespace fpga_stereo::test
